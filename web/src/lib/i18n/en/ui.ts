export const ui = {
  cancel: 'Cancel',
  close: 'Close',
  confirm: 'Confirm',
  save: 'Save',
  hold: 'Hold to confirm',
  holdHint: '{label}: hold to confirm',
  dismiss: 'Dismiss',
  progress: 'Progress',
} as const;
