import { MavCmd, MavFrame } from '$generated';

import { describe, expect, it } from 'vitest';

import { newItem } from '../logic/commands';
import { EMPTY_PLAN, item, waypoint, type Plan } from '../logic/model';
import { check } from '../logic/checks';
import { draftPlan, draftText } from '../logic/draft';
import { statisticsOf } from '../logic/statistics';
import { holdsAll, readPlan, writePlan } from '.';
import { writeWaypoints } from './waypoints';

const HOME = { latitude: 47.397, longitude: 8.545, altitude: 488 };
const whole: Plan = {
  ...EMPTY_PLAN,
  home: HOME,
  mission: [
    newItem(MavCmd.NAV_TAKEOFF, { ...HOME, altitude: 20 }),
    waypoint({ latitude: 47.398, longitude: 8.546 }, 30),
    item(MavCmd.DO_JUMP, [1, 3], 2),
    newItem(MavCmd.NAV_RETURN_TO_LAUNCH, HOME),
  ],
  polygons: [
    { inclusion: true, vertices: [0, 1, 2].map((each) => ({ latitude: 47 + each, longitude: 8 + each ** 2 })) },
  ],
  circles: [{ inclusion: false, center: { latitude: 47.4, longitude: 8.5 }, radius: 60 }],
  rally: [{ latitude: 47.39, longitude: 8.54, altitude: 25 }],
  returnPoint: { latitude: 47.1, longitude: 8.1, altitude: 40 },
  firmware: 3,
  hoverSpeed: 7,
};

const INPUT = { profile: null, clearance: 20, endurance: null, ceiling: null, vehicle: null, wing: false, firmware: 0 };

describe('plan files', () => {
  for (const format of ['plan', 'json'] as const) {
    it(`keep everything: ${format}`, () => {
      expect(readPlan(writePlan(whole, format, 'test'))).toEqual({ plan: whole, notes: [] });
    });
  }

  it('waypoints keep one kind of plan', () => {
    expect(readPlan(writePlan(whole, 'waypoints', '')).plan.mission).toEqual(whole.mission);
    expect(readPlan(writePlan(whole, 'waypoints', '')).plan.home).toEqual(HOME);
    expect(readPlan(writeWaypoints(whole, 'fence')).plan.polygons).toEqual(whole.polygons);
    expect(readPlan(writeWaypoints(whole, 'rally')).plan.rally).toEqual(whole.rally);
  });

  it('of QGroundControl with patterns give the items of the pattern', () => {
    const file = JSON.parse(writePlan(whole, 'plan', '')) as { mission: { items: unknown[] } };
    const [takeoff, ...rest] = file.mission.items;
    const survey = { type: 'ComplexItem', complexItemType: 'survey', TransectStyleComplexItem: { Items: rest } };
    file.mission.items = [takeoff, survey, { type: 'ComplexItem', complexItemType: 'new kind' }];
    const read = readPlan(JSON.stringify(file));
    const [kept, ...others] = [...read.plan.mission].reverse();
    expect(others.reverse()).toEqual(whole.mission);
    expect(kept!.kept!.kind).toBe('new kind');
    expect(read.notes).toEqual(['mission.items[2]: the new kind was not read, since the file holds no items of it']);
  });

  it('of QGroundControl are saved with the patterns that only it can compute', () => {
    const scan = { type: 'ComplexItem', complexItemType: 'StructureScan', Layers: 3, polygon: [[1, 2]] };
    const file = JSON.parse(writePlan(whole, 'plan', '')) as { mission: { items: unknown[] } };
    file.mission.items.splice(1, 0, scan);
    const { plan } = readPlan(JSON.stringify(file));
    const written = JSON.parse(writePlan(plan, 'plan', '')) as { mission: { items: unknown[] } };
    expect(written.mission.items[1]).toEqual(scan);
    // The jump names the same item: with the scan it is the third one.
    expect(readPlan(JSON.stringify(written)).plan.mission).toEqual(plan.mission);
    for (const format of ['json', 'waypoints'] as const) {
      expect(readPlan(writePlan(plan, format, '')).plan.mission).toEqual(whole.mission);
      expect(holdsAll(plan, format)).toBe(false);
    }
    expect(draftPlan(draftText(plan))).toEqual(plan);
    expect(check({ ...INPUT, plan, statistics: statisticsOf(plan) }).map((each) => each.key)).toContain('checkKept');
  });

  it('hold all of a plan or not', () => {
    expect(holdsAll(whole, 'plan')).toBe(true);
    const grouped = {
      ...whole,
      circles: [{ inclusion: true, center: { latitude: 1, longitude: 2 }, radius: 50, group: 1 }],
    };
    const aboveSea = { ...whole, rally: [{ latitude: 1, longitude: 2, altitude: 500, frame: MavFrame.GLOBAL }] };
    for (const plan of [grouped, aboveSea]) {
      expect(holdsAll(plan, 'plan')).toBe(false);
      expect(holdsAll(plan, 'json')).toBe(true);
      expect(readPlan(writePlan(plan, 'json', '')).plan).toEqual(plan);
    }
  });

  it('are kept by the browser, and nothing else is', () => {
    expect(draftPlan(draftText(whole))).toEqual(whole);
    for (const text of ['', '{', '{}', '{"plan": 1}', null, 5]) expect(draftPlan(text)).toEqual(EMPTY_PLAN);
  });

  it('that are wrong are told with the place', () => {
    const wrong: [string, string][] = [
      ['{', 'the file is not JSON'],
      ['{}', 'has none of mission, geoFence and rallyPoints'],
      [
        '{"mission": {"items": [{"command": 16, "params": [1]}]}}',
        'mission.items[0].params: has 1 numbers instead of 7',
      ],
      ['{"geoFence": {"polygons": [{"polygon": [[1, 2]]}]}}', 'geoFence.polygons[0]: a polygon needs at least 3'],
      ['QGC WPL 110\n0 1 2', 'line 2: has 3 columns instead of 12'],
      ['QGC WPL 7', 'QGC WPL 7 is not supported'],
      ['<kml></kml>', 'the file has no path, polygon or point'],
      ['# by hand\n\nQGC WPL 110\n\n0 1 2', 'line 5: has 3 columns'],
      ['PK\u0003\u0004 doc.kml', 'the file is an archive'],
      ['latitude;longitude', 'neither JSON, QGC WPL nor KML'],
      [
        '<kml><Point><coordinates>47.1,-122,0</coordinates></Point></kml>',
        '47.1,-122,0 is not a longitude and a latitude',
      ],
    ];
    for (const [text, reason] of wrong) expect(() => readPlan(text)).toThrow(reason);
  });

  it('of Google Earth become waypoints and areas', () => {
    const kml = `<?xml version="1.0"?><kml><Document>
      <Placemark><LineString><coordinates> 8.5,47.3,0 8.6,47.4,0 </coordinates></LineString></Placemark>
      <Placemark><Polygon><outerBoundaryIs><LinearRing>
        <coordinates>8,47 9,47 9,48 8,47</coordinates>
      </LinearRing></outerBoundaryIs></Polygon></Placemark>
      </Document></kml>`;
    const { plan } = readPlan(kml, 40);
    expect(plan.mission.map((each) => each.command)).toEqual([
      MavCmd.NAV_TAKEOFF,
      MavCmd.NAV_WAYPOINT,
      MavCmd.NAV_WAYPOINT,
    ]);
    expect(plan.mission[2]!.params.slice(4)).toEqual([47.4, 8.6, 40]);
    expect(plan.polygons[0]!.vertices).toHaveLength(3);
    const written = readPlan(writePlan(whole, 'kml', 'A & B')).plan;
    expect(written.polygons).toHaveLength(2);
    expect(written.mission.length).toBeGreaterThan(2);
  });
});
