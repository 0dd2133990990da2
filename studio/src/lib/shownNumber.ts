// Display of values whose last digits are of no interest.

/** A value for display, with three digits less than are of interest for a computation, and without trailing zeros. */
export function shownNumber(value: number, decimals: number): string {
  // The sum removes the sign of zero.
  return String(Number(value.toFixed(Math.max(decimals - 3, 2))) + 0);
}
