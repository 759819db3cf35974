/** A board that cannot be flashed, or a bootloader that refused a request. */
export class FlashingError extends Error {
  override name = 'FlashingError';
  /** The status of the bootloader; null: it did not answer, or the error is not one of the bootloader. */
  readonly status: number | null;

  constructor(text: string, status: number | null = null) {
    super(text);
    this.status = status;
  }
}
