// Moves the components of an assembly by the drives of its mechanism, which jointplay solves as they change.
using System;
using System.Collections.Generic;
using SolidWorks.Interop.sldworks;

namespace Jointplay.SolidWorks
{
    /// <summary>A mechanism whose links are components of the active assembly.</summary>
    public sealed class Driver : IDisposable
    {
        private readonly Mechanism mechanism;
        private readonly Places places;
        private readonly Dictionary<string, int> links = new Dictionary<string, int>();
        private readonly double[] positions;
        private readonly string[] names;
        private readonly bool[] isAngle;

        /// <summary>Links without a component.</summary>
        public List<string> Unmatched { get { return places.Unmatched; } }

        /// <summary>Matches the links to the components of the assembly, which is drawn at the reference configuration.</summary>
        /// <param name="toml">Text of the mechanism file.</param>
        public Driver(SldWorks application, string toml)
        {
            mechanism = Mechanism.Parse(toml);
            try
            {
                positions = mechanism.Home();
                double[] poses = mechanism.LinkPoses(positions);
                var drawn = new List<KeyValuePair<string, Pose>>();
                // The base does not move.
                for (int link = 1; link < mechanism.LinkCount; link++)
                {
                    string name = mechanism.LinkName(link);
                    links[name] = link;
                    drawn.Add(new KeyValuePair<string, Pose>(name, Pose.OfRows(poses, 16 * link)));
                }
                places = new Places(application, drawn);
                places.Check(link => true);
                names = new string[mechanism.DriveCount];
                isAngle = new bool[names.Length];
                for (int drive = 0; drive < names.Length; drive++)
                {
                    var coordinate = (UIntPtr)Native.jp_mechanism_drive_coordinate(mechanism.Pointer, (UIntPtr)drive);
                    names[drive] = Native.Text(Native.jp_mechanism_coordinate_name(mechanism.Pointer, coordinate));
                    isAngle[drive] = Native.jp_mechanism_coordinate_is_angle(mechanism.Pointer, coordinate) == 1;
                }
            }
            catch
            {
                mechanism.Dispose();
                throw;
            }
        }

        /// <summary>Names of the drives.</summary>
        public IList<string> Drives { get { return Array.AsReadOnly(names); } }

        /// <summary>Solves for values of drives (mm, degrees), and places the components; drives without a value keep theirs.</summary>
        public void Show(IDictionary<string, double> values)
        {
            foreach (string name in values.Keys)
                if (Array.IndexOf(names, name) < 0) throw new PlaybackException(name + " is no drive; drives are " + string.Join(", ", names));
            var drives = new double[names.Length];
            for (int k = 0; k < names.Length; k++)
            {
                double value;
                int coordinate = Native.jp_mechanism_drive_coordinate(mechanism.Pointer, (UIntPtr)k);
                drives[k] = values.TryGetValue(names[k], out value)
                    ? (isAngle[k] ? value * Math.PI / 180 : value / 1000)
                    : positions[coordinate];
            }
            // Positions of a failed solution are discarded.
            var solved = (double[])positions.Clone();
            mechanism.Solve(drives, solved);
            Array.Copy(solved, positions, positions.Length);
            double[] poses = mechanism.LinkPoses(positions);
            places.Show(link => Pose.OfRows(poses, 16 * links[link]));
        }

        public void Dispose() { mechanism.Dispose(); }
    }
}
