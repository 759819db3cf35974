/** Settings that the browser keeps. */

export type Theme = 'auto' | 'dark' | 'light';
export type UnitSystem = 'metric' | 'imperial' | 'nautical';

const PREFIX = 'mavstack.';

function stored<Value>(key: string, fallback: Value, choices?: readonly Value[]): Value {
  try {
    const text = localStorage.getItem(PREFIX + key);
    if (text === null) return fallback;
    const value = JSON.parse(text) as Value;
    return choices === undefined || choices.includes(value) ? value : fallback;
  } catch {
    // No storage (private windows, tests), or text of another version.
    return fallback;
  }
}

function store(key: string, value: unknown): void {
  try {
    localStorage.setItem(PREFIX + key, JSON.stringify(value));
  } catch {
    // A setting that cannot be kept holds until the page is left.
  }
}

/** A reactive value that the browser keeps; `value` is replaced, never changed in place. */
export class Persisted<Value> {
  private readonly key: string;
  private current: Value = $state.raw() as Value;

  /**
   * Creates the value.
   *
   * @param key - Begins with the view's name, such as `inspect.columns`.
   * @param choices - All values that are possible; another one that the browser kept is ignored.
   */
  constructor(key: string, fallback: Value, choices?: readonly Value[]) {
    this.key = key;
    this.current = stored(key, fallback, choices);
  }

  get value(): Value {
    return this.current;
  }

  set value(value: Value) {
    this.current = value;
    store(this.key, value);
  }
}

/** Settings of the whole station. */
export const settings = {
  theme: new Persisted<Theme>('theme', 'auto', ['auto', 'dark', 'light']),
  units: new Persisted<UnitSystem>('units', 'metric', ['metric', 'imperial', 'nautical']),
  /** URL of raster tiles with {z}/{x}/{y}, of a PMTiles archive, or empty: the generated base layer. */
  tiles: new Persisted<string>('tiles', ''),
  attribution: new Persisted<string>('attribution', ''),
  /** Alerts and changes of the mode are spoken. */
  speech: new Persisted<boolean>('speech', false, [false, true]),
  language: new Persisted<string>('language', 'en'),
};
