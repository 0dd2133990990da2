// Comparison of robots.

/** Members of the document of a robot that belong to the server and not to the file of the robot. */
const OF_SERVER = ['version', 'cell', 'controller', 'mechanism', 'series_formats', 'default_model'];

/** Identifies a robot by everything that its file determines. */
export function robotKey(robot: object): string {
  return JSON.stringify(Object.entries(robot).filter(([name]) => !OF_SERVER.includes(name)).sort(([a], [b]) => (a < b ? -1 : 1)));
}
