/** Values of instruments that change only as far as a picture shows it. */

/** A tenth of a degree, of a metre or of m/s is less than a pixel. */
const STEPS = 10;

/** Returns a function that returns its previous argument as long as the new one looks the same. */
export function steady<Values extends object>(): (next: Values) => Values {
  let shown: Values | null = null;
  return (next) => {
    if (shown === null || !looksSame(shown, next)) shown = next;
    return shown;
  };
}

function looksSame(one: object, other: object): boolean {
  const [before, after] = [Object.entries(one), Object.entries(other)];
  return (
    before.length === after.length &&
    before.every(([name, value], index) => {
      const [otherName, otherValue] = after[index]!;
      return name === otherName && rounded(value) === rounded(otherValue);
    })
  );
}

function rounded(value: unknown): unknown {
  return typeof value === 'number' && Number.isFinite(value) ? Math.round(value * STEPS) : value;
}
