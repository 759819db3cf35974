import { describe, expect, it } from 'vitest';
import cases from './template-cases.json';
import { TemplateError, parseRow, parseTemplates } from './template';

describe('rows', () => {
  it.each(cases.rows)('$template reads $line', ({ template, line, message, fields }) => {
    expect(parseRow(parseTemplates(template), line)).toEqual(message === null ? null : { message, fields });
  });
});

describe('templates', () => {
  it.each(cases.refused)('%j is refused', (text) => {
    expect(() => parseTemplates(text)).toThrow(TemplateError);
  });

  it('hold units', () => {
    const [template] = parseTemplates('lat:deg,_,alt:m');
    expect(template!.columns.map((column) => column?.unit)).toEqual(['deg', undefined, 'm']);
  });

  it('have a bounded number of columns', () => {
    const names = Array.from({ length: 200 }, (_, index) => `c${index}`);
    expect(() => parseTemplates(names.join(','))).toThrow('128');
  });
});
