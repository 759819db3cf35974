export const ui = {
  cancel: 'Cancel',
  close: 'Close',
  save: 'Save',
  hold: 'Hold to confirm',
  holdHint: '{label}: hold to confirm',
  dismiss: 'Dismiss',
} as const;
