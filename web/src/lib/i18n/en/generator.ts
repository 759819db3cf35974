export const generator = {
  title: 'Libraries in other languages',
  about:
    'Message classes, a parser and a builder of packets for your own programs, from an official dialect or your ' +
    'definition file.',
  dialect: 'Dialect',
  file: 'Definition file',
  fileHint: 'Your own MAVLink XML; it may include official files',
  useOfficial: 'Use an official dialect',
  languages: 'Languages',
  only: 'Only these messages',
  onlyHint: 'Empty: all. Names and patterns with commas: HEARTBEAT, GPS*',
  exclude: 'Without these messages',
  package: 'Package or namespace',
  packageHint: 'Empty: the default of the language',
  generate: 'Generate and download',
  generating: 'The libraries are generated …',
  commands: 'The same on the command line',
  done: 'Saved as {name}',
  copy: 'Copy the commands',
  copied: 'Copied',
  stationOnly: 'The generator is part of the station; this page runs without it.',
} as const;
