/** Spoken texts: each once, and again only after a while. */

/** Milliseconds in which the same text is not spoken again. */
export const REPEAT_AFTER = 20_000;

/** The part of the browser's voice that is used. */
export interface Voice {
  speak(text: string): void;
  stop(): void;
}

/** Returns the voice of the browser, or null if it has none. */
export function browserVoice(language: string): Voice | null {
  if (typeof speechSynthesis === 'undefined') return null;
  return {
    speak(text) {
      const utterance = new SpeechSynthesisUtterance(text);
      utterance.lang = language;
      speechSynthesis.speak(utterance);
    },
    stop: () => speechSynthesis.cancel(),
  };
}

export class Announcer {
  private readonly voice: Voice;
  private readonly spoken = new Map<string, number>();

  constructor(voice: Voice) {
    this.voice = voice;
  }

  /**
   * Speaks those texts that are new; a text that is gone and comes back within a while stays silent.
   *
   * @param texts - The texts that hold now, such as alerts.
   * @param now - In ms.
   */
  announce(texts: readonly string[], now: number): void {
    for (const text of texts) {
      const last = this.spoken.get(text);
      this.spoken.set(text, now);
      if (last === undefined) this.voice.speak(text);
    }
    for (const [text, time] of this.spoken) {
      if (!texts.includes(text) && now - time > REPEAT_AFTER) this.spoken.delete(text);
    }
  }

  stop(): void {
    this.spoken.clear();
    this.voice.stop();
  }
}
