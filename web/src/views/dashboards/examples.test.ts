import { describe, expect, it } from 'vitest';
import { messageInfo } from '$lib/decoder/Decoder';
import { parseTemplates } from '$lib/rows/template';
import { problemOf } from '$lib/scripts/sandbox';
import { EXAMPLES } from './examples';
import { overlaps } from './layout';
import { loadDashboard, saveDashboard } from './model';

describe.each(EXAMPLES)('$id', ({ dashboard }) => {
  it('can be saved and loaded', () => {
    expect(loadDashboard(saveDashboard(dashboard))).toEqual(dashboard);
  });

  it('has no overlapping widgets', () => {
    const { widgets } = dashboard;
    for (const a of widgets) for (const b of widgets) if (a !== b) expect(overlaps(a, b)).toBe(false);
  });

  it('shows fields that exist', () => {
    const columns = dashboard.sources.flatMap((url) => {
      const query = new URL(url.replace('csv+tcp', 'http')).searchParams;
      const templates = query.has('template') ? parseTemplates(query.get('template')!) : [];
      return templates.flatMap((each) =>
        each.columns.map((column) => `${query.get('name')}:${each.message}.${column?.name}`),
      );
    });
    for (const { ref } of dashboard.widgets.flatMap((widget) => widget.fields)) {
      const known = messageInfo(ref.message)?.fields.some((each) => each.name === ref.field);
      const computed =
        ref.source.startsWith('script:') && dashboard.scripts.some(({ name }) => ref.source.endsWith(name));
      expect(known || computed || columns.includes(`${ref.source}:${ref.message}.${ref.field}`), ref.field).toBe(true);
    }
  });

  it('has scripts that can run', () => {
    for (const { code } of dashboard.scripts) expect(problemOf(code)).toBeNull();
  });
});
