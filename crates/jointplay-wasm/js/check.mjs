// Compares the module with the numbers of the Rust library, in Node and in browsers.

/** Largest difference from the numbers of the library: of those above one, relative to them. */
export const BOUND = 1e-12;

/** Differences of two results; how a solution was found is not compared. */
function differences(found, expected, where) {
  if (typeof expected === 'number') {
    const off = Math.abs(found - expected) / Math.max(1, Math.abs(expected));
    return off <= BOUND ? [] : [`${where} is ${found}, expected ${expected}`];
  }
  if (expected === null || typeof expected !== 'object') return found === expected ? [] : [`${where} is ${String(found)}, expected ${String(expected)}`];
  if (JSON.stringify(Object.keys(found ?? {}).sort()) !== JSON.stringify(Object.keys(expected).sort())) return [`${where} has other entries: ${Object.keys(found ?? {})}`];
  return Object.keys(expected).flatMap((key) => (key === 'iterations' || key === 'residual_m' ? [] : differences(found[key], expected[key], `${where}.${key}`)));
}

/** All differences between the module and the cases of `native.json`. */
export function check({ Robot, JointplayError }, module, cases) {
  return cases.flatMap(({ robot, call, arguments: input, result }, i) => {
    const run = () => {
      try {
        return new Robot(module, robot)[call](...input);
      } catch (error) {
        if (!(error instanceof JointplayError)) throw error;
        return { kind: error.kind, message: error.message };
      }
    };
    return differences(run(), result, `case ${i}, ${call}(${JSON.stringify(input)})`);
  });
}
