// The parts of SolidWorks' interfaces that the playback and the add-in use, written from its public help, for builds without SolidWorks.
// Build against SolidWorks.Interop.sldworks.dll and SolidWorks.Interop.swpublished.dll of an installation instead of this file.
namespace SolidWorks.Interop.sldworks
{
    public interface MathTransform
    {
        // 16 numbers: images of the axes x, y and z, the translation (m), the scale, three zeros.
        object ArrayData { get; set; }
    }

    public interface MathUtility
    {
        object CreateTransform(object ArrayData);
    }

    public interface Component2
    {
        string Name2 { get; }
        MathTransform Transform2 { get; set; }
        bool IsFixed();
    }

    public interface EquationMgr
    {
        int GetCount();
        string get_Equation(int Index);
        double get_Value(int Index);
    }

    public interface ModelDoc2
    {
        void GraphicsRedraw2();
        EquationMgr GetEquationMgr();
    }

    public interface AssemblyDoc
    {
        object GetComponents(bool ToplevelOnly);
    }

    public interface SldWorks
    {
        object ActiveDoc { get; }
        object GetMathUtility();
        bool SetAddinCallbackInfo2(long ModuleHandle, object AddinCallbacks, int Cookie);
        CommandManager GetCommandManager(int Cookie);
        string GetOpenFileName(string DialogTitle, string InitialFileName, string FileFilter, out int OpenOptions, out string ConfigName, out string DisplayName);
        int SendMsgToUser2(string Message, int Icon, int Buttons);
    }

    public interface CommandManager
    {
        CommandGroup CreateCommandGroup2(int UserID, string Title, string ToolTip, string Hint, int Position, bool IgnorePreviousVersion, ref int Errors);
        int RemoveCommandGroup2(int UserID, bool RuntimeOnly);
    }

    public interface CommandGroup
    {
        bool HasMenu { get; set; }
        bool HasToolbar { get; set; }
        int AddCommandItem2(string Name, int Position, string HintString, string ToolTip, int ImageListIndex, string CallbackFunction, string EnableMethod, int UserID, int MenuTBOption);
        bool Activate();
    }
}

namespace SolidWorks.Interop.swpublished
{
    public interface ISwAddin
    {
        bool ConnectToSW(object ThisSW, int Cookie);
        bool DisconnectFromSW();
    }
}
