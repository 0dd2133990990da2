// The parts of SolidWorks' interfaces that the playback uses, written from its public help, for builds without SolidWorks.
// Build against SolidWorks.Interop.sldworks.dll of an installation instead of this file.
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

    public interface ModelDoc2
    {
        void GraphicsRedraw2();
    }

    public interface AssemblyDoc
    {
        object GetComponents(bool ToplevelOnly);
    }

    public interface SldWorks
    {
        object ActiveDoc { get; }
        object GetMathUtility();
    }
}
