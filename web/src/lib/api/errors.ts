/** The error of all actions, by the station's API or by MAVLink in the page. */

export class StationError extends Error {
  /** Class of the error, such as `CommandDenied`, `RemoteTimeout`, `Forbidden`, `Unreachable`. */
  readonly kind: string;
  /** Status texts of the vehicle: its reasons. */
  readonly statusTexts: readonly string[];
  /** Result code of the vehicle, or null. */
  readonly code: number | null;

  constructor(kind: string, text: string, statusTexts: readonly string[] = [], code: number | null = null) {
    super(text);
    this.name = 'StationError';
    this.kind = kind;
    this.statusTexts = statusTexts;
    this.code = code;
  }
}

/** Returns the text of any error for people. */
export function textOf(error: unknown): string {
  return error instanceof Error ? error.message : String(error);
}
