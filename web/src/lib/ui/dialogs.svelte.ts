/** The open modal dialogs, the topmost last: what must be seen above all, such as toasts, is shown in that one. */
class Dialogs {
  private stack: readonly string[] = $state.raw([]);

  /** Id of the topmost open dialog; null: none is open. */
  get top(): string | null {
    return this.stack.at(-1) ?? null;
  }

  /** Adds a dialog; returns the function that removes it. */
  add(id: string): () => void {
    this.stack = [...this.stack, id];
    return () => (this.stack = this.stack.filter((each) => each !== id));
  }
}

export const dialogs = new Dialogs();
