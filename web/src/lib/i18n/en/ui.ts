export const ui = {
  cancel: 'Cancel',
  close: 'Close',
  save: 'Save',
  hold: 'Hold to confirm',
  mapFailed: 'The map cannot be drawn: {reason}',
  archiveFailed: 'The map archive cannot be read: {reason}',
  tilesFailed: 'The map tiles cannot be read: is the address right, and does its server allow this page?',
  holdHint: '{label}: hold to confirm',
  dismiss: 'Dismiss',
} as const;
