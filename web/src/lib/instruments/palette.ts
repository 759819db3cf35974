/** Colours of the instruments. They follow the conventions of flight displays and stay the same in both themes. */
export interface InstrumentPalette {
  readonly skyHigh: string;
  readonly skyLow: string;
  readonly groundHigh: string;
  readonly groundLow: string;
  readonly line: string;
  readonly text: string;
  readonly faint: string;
  readonly panel: string;
  readonly aircraft: string;
  readonly outline: string;
  readonly bug: string;
  readonly warning: string;
  readonly unknown: string;
}

/** Blue, brown, white and yellow differ in brightness too, so that hues need not be told apart. */
export const PALETTE: InstrumentPalette = {
  skyHigh: '#123f7a',
  skyLow: '#4f94d8',
  groundHigh: '#8a5f35',
  groundLow: '#452b14',
  line: '#ffffff',
  text: '#ffffff',
  faint: 'rgba(255, 255, 255, 0.62)',
  panel: 'rgba(8, 14, 24, 0.46)',
  aircraft: '#ffd23f',
  outline: 'rgba(4, 8, 14, 0.9)',
  bug: '#ff9ed2',
  warning: '#ffb000',
  unknown: '#2a3442',
};

export const FONT = 'system-ui, "Segoe UI", Roboto, "Noto Sans", sans-serif';
