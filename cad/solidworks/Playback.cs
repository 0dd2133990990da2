// Plays a motion in an assembly of SolidWorks by the places of its components: no licence of SolidWorks Motion is needed.
//
// The motion is a table of `jointplay move MECHANISM --drive … --poses`, whose columns `LINK_x_mm` to `LINK_qz` are the
// poses of links in the base frame. The base frame is that of the assembly; the assembly is drawn as in the first row.
using System;
using System.Collections.Generic;
using System.Globalization;
using System.IO;
using System.Text.RegularExpressions;
using SolidWorks.Interop.sldworks;

namespace Jointplay.SolidWorks
{
    /// <summary>A table or an assembly that cannot be played.</summary>
    public sealed class PlaybackException : Exception
    {
        public PlaybackException(string message) : base(message) { }
    }

    /// <summary>A rigid displacement: rotation by columns and translation [m].</summary>
    public sealed class Pose
    {
        // Rows of the 3×4 matrix; column vectors are multiplied from the right.
        private readonly double[,] rows = new double[3, 4];

        /// <summary>Pose from a unit quaternion (real part first) and a translation [m].</summary>
        public static Pose Of(double w, double x, double y, double z, double px, double py, double pz)
        {
            double norm = Math.Sqrt(w * w + x * x + y * y + z * z);
            if (!(Math.Abs(norm - 1) < 1e-6)) throw new PlaybackException("a quaternion of the table has the norm " + norm + ", expected 1");
            w /= norm; x /= norm; y /= norm; z /= norm;
            double[,] rotation =
            {
                { 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y) },
                { 2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x) },
                { 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y) },
            };
            var pose = new Pose();
            double[] point = { px, py, pz };
            for (int i = 0; i < 3; i++)
            {
                for (int j = 0; j < 3; j++) pose.rows[i, j] = rotation[i, j];
                pose.rows[i, 3] = point[i];
            }
            return pose;
        }

        /// <summary>Pose from the array of a transform of SolidWorks, which multiplies row vectors from the left.</summary>
        public static Pose OfArray(double[] array)
        {
            var pose = new Pose();
            for (int i = 0; i < 3; i++)
            {
                for (int j = 0; j < 3; j++) pose.rows[i, j] = array[3 * j + i];
                pose.rows[i, 3] = array[9 + i];
            }
            return pose;
        }

        /// <summary>Pose from 16 numbers by rows, as in jointplay.h, beginning at an index.</summary>
        public static Pose OfRows(double[] rows, int from)
        {
            var pose = new Pose();
            for (int i = 0; i < 3; i++)
                for (int j = 0; j < 4; j++) pose.rows[i, j] = rows[from + 4 * i + j];
            return pose;
        }

        /// <summary>Whether a pose differs by more than round-off.</summary>
        public bool DiffersFrom(Pose other)
        {
            for (int i = 0; i < 3; i++)
                for (int j = 0; j < 4; j++) if (Math.Abs(rows[i, j] - other.rows[i, j]) > 1e-12) return true;
            return false;
        }

        /// <summary>The array of a transform of SolidWorks: images of x, y and z, translation [m], scale 1, zeros.</summary>
        public double[] ToArray()
        {
            var array = new double[16];
            for (int i = 0; i < 3; i++)
            {
                for (int j = 0; j < 3; j++) array[3 * j + i] = rows[i, j];
                array[9 + i] = rows[i, 3];
            }
            array[12] = 1;
            return array;
        }

        public static Pose operator *(Pose a, Pose b)
        {
            var product = new Pose();
            for (int i = 0; i < 3; i++)
                for (int j = 0; j < 4; j++)
                {
                    double sum = j == 3 ? a.rows[i, 3] : 0;
                    for (int k = 0; k < 3; k++) sum += a.rows[i, k] * b.rows[k, j];
                    product.rows[i, j] = sum;
                }
            return product;
        }

        public Pose Inverse()
        {
            var inverse = new Pose();
            for (int i = 0; i < 3; i++)
            {
                for (int j = 0; j < 3; j++) inverse.rows[i, j] = rows[j, i];
                for (int k = 0; k < 3; k++) inverse.rows[i, 3] -= rows[k, i] * rows[k, 3];
            }
            return inverse;
        }
    }

    /// <summary>Poses of links along a motion.</summary>
    public sealed class PoseTable
    {
        private static readonly string[] Endings = { "_qw", "_qx", "_qy", "_qz", "_x_mm", "_y_mm", "_z_mm" };

        /// <summary>Poses of each link, one for each row.</summary>
        public readonly Dictionary<string, List<Pose>> Links = new Dictionary<string, List<Pose>>();
        /// <summary>Number of rows.</summary>
        public int Count { get; private set; }

        public static PoseTable Read(TextReader reader)
        {
            string[] headings = (reader.ReadLine() ?? "").TrimStart('\uFEFF').Split(',');
            var columns = new Dictionary<string, int[]>();
            for (int k = 0; k < headings.Length; k++)
            {
                if (!headings[k].EndsWith("_qw", StringComparison.Ordinal)) continue;
                string link = headings[k].Substring(0, headings[k].Length - 3);
                int[] found = Array.ConvertAll(Endings, ending => Array.IndexOf(headings, link + ending));
                if (Array.IndexOf(found, -1) >= 0) throw new PlaybackException("the table has no whole pose of " + link + ": make it with jointplay move --poses");
                columns[link] = found;
            }
            if (columns.Count == 0) throw new PlaybackException("the table has no poses: make it with jointplay move --poses");
            var table = new PoseTable();
            foreach (string link in columns.Keys) table.Links[link] = new List<Pose>();
            for (string line = reader.ReadLine(); line != null; line = reader.ReadLine())
            {
                if (line.Trim().Length == 0) continue;
                string[] cells = line.Split(',');
                table.Count++;
                foreach (var one in columns)
                {
                    var v = new double[7];
                    for (int k = 0; k < 7; k++)
                        if (one.Value[k] >= cells.Length
                            || !double.TryParse(cells[one.Value[k]], NumberStyles.Float, CultureInfo.InvariantCulture, out v[k])
                            || double.IsNaN(v[k]) || double.IsInfinity(v[k]))
                            throw new PlaybackException("row " + table.Count + " of the table has no number for " + one.Key + Endings[k]);
                    table.Links[one.Key].Add(Pose.Of(v[0], v[1], v[2], v[3], v[4] / 1000, v[5] / 1000, v[6] / 1000));
                }
            }
            if (table.Count == 0) throw new PlaybackException("the table has no rows");
            return table;
        }
    }

    /// <summary>Components of the active assembly that move with links.</summary>
    public sealed class Places
    {
        private sealed class Placed
        {
            public string Link;
            public Component2 Component;
            /// <summary>Place of the component in the frame of its link.</summary>
            public Pose InLink;
            public Pose Drawn;
        }

        private readonly MathUtility utility;
        private readonly ModelDoc2 model;
        private readonly List<Placed> placed = new List<Placed>();

        /// <summary>Links without a component.</summary>
        public readonly List<string> Unmatched = new List<string>();

        /// <summary>Matches links to the components of their names, with or without the number that SolidWorks appends.</summary>
        /// <param name="drawn">Poses of the links at which the assembly is drawn.</param>
        public Places(SldWorks application, IEnumerable<KeyValuePair<string, Pose>> drawn)
        {
            object document = application.ActiveDoc;
            var assembly = document as AssemblyDoc;
            if (assembly == null) throw new PlaybackException("open the assembly first");
            model = (ModelDoc2)document;
            utility = (MathUtility)application.GetMathUtility();
            var components = (assembly.GetComponents(true) as object[]) ?? new object[0];
            foreach (var link in drawn)
            {
                Component2 found = null;
                foreach (Component2 component in components)
                {
                    if (component.Name2 != link.Key && Regex.Replace(component.Name2, "-[0-9]+$", "") != link.Key) continue;
                    if (found != null) throw new PlaybackException("two components have the name of the link " + link.Key + ": " + found.Name2 + " and " + component.Name2);
                    found = component;
                }
                if (found == null) { Unmatched.Add(link.Key); continue; }
                Pose at = Pose.OfArray((double[])found.Transform2.ArrayData);
                placed.Add(new Placed { Link = link.Key, Component = found, InLink = link.Value.Inverse() * at, Drawn = link.Value });
            }
        }

        /// <summary>Rejects fixed components of moving links, and assemblies without a component of a moving link.</summary>
        /// <param name="moves">Whether a link moves from its drawn pose.</param>
        public void Check(Func<string, bool> moves)
        {
            bool any = false;
            foreach (var one in placed)
            {
                // A link that does not move may be fixed.
                if (!one.Component.IsFixed()) { any = true; continue; }
                if (moves(one.Link)) throw new PlaybackException("the component " + one.Component.Name2 + " is fixed: set it to float");
            }
            if (!any) throw new PlaybackException("no component has the name of a link that moves");
            placed.RemoveAll(one => one.Component.IsFixed());
        }

        /// <summary>Places the components for poses of the links, and draws them.</summary>
        public void Show(Func<string, Pose> pose)
        {
            foreach (var one in placed)
                one.Component.Transform2 = (MathTransform)utility.CreateTransform((pose(one.Link) * one.InLink).ToArray());
            model.GraphicsRedraw2();
        }
    }

    /// <summary>A motion of the components of the active assembly.</summary>
    public sealed class Playback
    {
        private readonly PoseTable table;
        private readonly Places places;

        /// <summary>Links without a component.</summary>
        public List<string> Unmatched { get { return places.Unmatched; } }
        /// <summary>Number of configurations.</summary>
        public readonly int Count;

        /// <summary>Matches the links to the components of the assembly, which is drawn as in the first row.</summary>
        public Playback(SldWorks application, PoseTable table)
        {
            this.table = table;
            Count = table.Count;
            var first = new List<KeyValuePair<string, Pose>>();
            foreach (var link in table.Links) first.Add(new KeyValuePair<string, Pose>(link.Key, link.Value[0]));
            places = new Places(application, first);
            places.Check(link => table.Links[link].Exists(pose => pose.DiffersFrom(table.Links[link][0])));
        }

        /// <summary>Places the components in a configuration, and draws them.</summary>
        public void Show(int configuration)
        {
            places.Show(link => table.Links[link][configuration]);
        }
    }
}
