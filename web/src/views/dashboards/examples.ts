/** The dashboards that come with the station; `mav sim` and `examples/dashboards/csv_sender.py` send their data. */
import { parseFieldRef } from '$lib/series/fieldRef';

import { fieldOf, newWidget, type Dashboard, type Widget, type WidgetField, type WidgetKind } from './model';

type Options = Partial<Omit<Widget, 'kind' | 'fields' | 'id'>>;
const DEGREES = 180 / Math.PI;

function field(text: string, label: string, unit = '', factor = 1): WidgetField {
  const ref = parseFieldRef(text);
  if (ref === null) throw new Error(`${text} is not a field`);
  return fieldOf(ref, { label, unit, factor });
}

function widget(
  id: string,
  kind: WidgetKind,
  place: readonly [number, number, number, number],
  fields: readonly WidgetField[],
  options: Options,
): Widget {
  const [x, y, width, height] = place;
  return { ...newWidget(kind, fields), ...options, id, x, y, width, height };
}

const ZERMATT_SOURCES = ['tcpout://127.0.0.1:5760', 'tcpout://127.0.0.1:5761'];
const ZERMATT_COLUMNS = 'time:s,lat:deg,lon:deg,alt:m,roll:deg,pitch:deg,yaw:deg,speed:m/s,battery:V';
const ZERMATT_CSV_SOURCES = ['north', 'south'].map(
  (name, index) => `csv+tcp://127.0.0.1:${5781 + index}?name=${name}&template=${ZERMATT_COLUMNS}`,
);
const CANSAT_SOURCES = [
  'csv+tcp://127.0.0.1:5790?name=cansat&template=' +
    'time:s,lat:deg,lon:deg,alt:m,temperature:degC,pressure:hPa,ax:m/s2,ay:m/s2,az:m/s2,roll:deg,pitch:deg,yaw:deg',
];

/** The fields of one drone, however they come. */
interface Drone {
  readonly name: string;
  readonly latitude: WidgetField;
  readonly longitude: WidgetField;
  readonly altitude: WidgetField;
  readonly speed: WidgetField;
  readonly roll: WidgetField;
  readonly pitch: WidgetField;
  readonly heading: WidgetField;
  readonly battery: WidgetField;
}

function mavlinkDrone(system: number): Drone {
  const name = `Drone ${system}`;
  return {
    name,
    latitude: field(`${system}:GLOBAL_POSITION_INT.lat`, name, 'deg', 1e-7),
    longitude: field(`${system}:GLOBAL_POSITION_INT.lon`, name, 'deg', 1e-7),
    altitude: field(`${system}:GLOBAL_POSITION_INT.alt`, name, 'm', 1e-3),
    speed: field(`${system}:VFR_HUD.groundspeed`, name, 'm/s'),
    roll: field(`${system}:ATTITUDE.roll`, name, 'deg', DEGREES),
    pitch: field(`${system}:ATTITUDE.pitch`, name, 'deg', DEGREES),
    heading: field(`${system}:VFR_HUD.heading`, name, 'deg'),
    battery: field(`${system}:SYS_STATUS.voltage_battery`, name, 'V', 1e-3),
  };
}

function csvDrone(source: string, name: string): Drone {
  const column = (word: string, unit: string): WidgetField => field(`${source}:ROW.${word}`, name, unit);
  return {
    name,
    latitude: column('lat', 'deg'),
    longitude: column('lon', 'deg'),
    altitude: column('alt', 'm'),
    speed: column('speed', 'm/s'),
    roll: column('roll', 'deg'),
    pitch: column('pitch', 'deg'),
    heading: column('yaw', 'deg'),
    battery: column('battery', 'V'),
  };
}

function twoDrones(title: string, sources: readonly string[], [one, two]: readonly [Drone, Drone]): Dashboard {
  return {
    title,
    sources,
    scripts: [],
    decoders: [],
    widgets: [
      widget('map', 'map', [0, 0, 6, 8], [one.latitude, one.longitude, two.latitude, two.longitude], { title: 'Map' }),
      widget('horizon1', 'horizon', [6, 0, 3, 4], [one.roll, one.pitch], { title: one.name }),
      widget('horizon2', 'horizon', [9, 0, 3, 4], [two.roll, two.pitch], { title: two.name }),
      widget('compass1', 'compass', [6, 4, 3, 4], [one.heading], { title: `${one.name}: heading` }),
      widget('compass2', 'compass', [9, 4, 3, 4], [two.heading], { title: `${two.name}: heading` }),
      widget('altitude', 'plot', [0, 8, 6, 5], [one.altitude, two.altitude], {
        title: 'Altitude above sea level',
        window: 60,
      }),
      widget('speed', 'plot', [6, 8, 4, 5], [one.speed, two.speed], { title: 'Ground speed', window: 60 }),
      widget('battery1', 'value', [10, 8, 2, 2], [one.battery], { title: `${one.name}: battery`, decimals: 2 }),
      widget('battery2', 'value', [10, 10, 2, 3], [two.battery], { title: `${two.name}: battery`, decimals: 2 }),
    ],
  };
}

function cansat(): Dashboard {
  const column = (word: string, label: string, unit: string): WidgetField => field(`cansat:ROW.${word}`, label, unit);
  const altitude = column('alt', 'Altitude', 'm');
  const attitude = ['roll', 'pitch', 'yaw'].map((word) => column(word, word, 'deg'));
  const acceleration = ['ax', 'ay', 'az'].map((word) => column(word, word, 'm/s²'));
  return {
    title: 'CanSat',
    sources: CANSAT_SOURCES,
    scripts: [
      {
        name: 'descent',
        frames: '',
        inputs: { altitude: altitude.ref, time: column('time', '', 's').ref },
        code: CANSAT_SCRIPT,
      },
    ],
    decoders: [],
    widgets: [
      widget('altitude', 'plot', [0, 0, 6, 5], [altitude], { title: 'Altitude', window: 120 }),
      widget('rate', 'gauge', [6, 0, 3, 5], [field('script:descent:OUT.rate', 'Climb rate', 'm/s')], {
        title: 'Climb rate',
        minimum: -20,
        maximum: 20,
      }),
      widget('attitude', 'attitude', [9, 0, 3, 5], attitude, { title: 'Attitude' }),
      widget('map', 'map', [0, 5, 4, 6], [column('lat', 'CanSat', 'deg'), column('lon', 'CanSat', 'deg')], {
        title: 'Map',
      }),
      widget('acceleration', 'plot', [4, 5, 5, 3], acceleration, { title: 'Acceleration', window: 20 }),
      widget('spectrum', 'fft', [4, 8, 5, 3], [acceleration[2]!], { title: 'Spectrum of az' }),
      widget('temperature', 'gauge', [9, 5, 3, 4], [column('temperature', 'Temperature', '°C')], {
        title: 'Temperature',
        minimum: -20,
        maximum: 40,
      }),
      widget('pressure', 'value', [9, 9, 3, 2], [column('pressure', 'Pressure', 'hPa')], { title: 'Pressure' }),
    ],
  };
}

/** The rate of climb from the times and altitudes of the device itself, smoothed. */
const CANSAT_SCRIPT = `if (values.altitude === null || values.time === null) return {};
const elapsed = values.time - (state.time ?? values.time);
if (elapsed > 0) {
  const rate = (values.altitude - state.altitude) / elapsed;
  state.rate = state.rate === undefined ? rate : 0.8 * state.rate + 0.2 * rate;
}
if (elapsed !== 0 || state.time === undefined) {
  state.time = values.time;
  state.altitude = values.altitude;
}
return { rate: state.rate };`;

function oneVehicle(): Dashboard {
  const drone = mavlinkDrone(1);
  return {
    title: 'One vehicle',
    sources: [],
    scripts: [],
    decoders: [],
    widgets: [
      widget(
        'attitude',
        'attitude',
        [0, 0, 3, 5],
        [drone.roll, drone.pitch, field('1:ATTITUDE.yaw', 'yaw', 'deg', DEGREES)],
        { title: 'Attitude' },
      ),
      widget(
        'angles',
        'plot',
        [3, 0, 6, 5],
        [
          { ...drone.roll, label: 'Roll' },
          { ...drone.pitch, label: 'Pitch' },
        ],
        { title: 'Roll and pitch' },
      ),
      widget('speed', 'gauge', [9, 0, 3, 5], [drone.speed], { title: 'Ground speed', maximum: 25 }),
      widget('map', 'map', [0, 5, 6, 6], [drone.latitude, drone.longitude], { title: 'Map' }),
      widget('altitude', 'plot', [6, 5, 6, 4], [field('1:GLOBAL_POSITION_INT.relative_alt', 'Altitude', 'm', 1e-3)], {
        title: 'Altitude above home',
        window: 60,
      }),
      widget('battery', 'value', [6, 9, 3, 2], [drone.battery], { title: 'Battery', decimals: 2 }),
      widget('climb', 'value', [9, 9, 3, 2], [field('1:VFR_HUD.climb', 'Climb', 'm/s')], {
        title: 'Climb rate',
        decimals: 2,
      }),
    ],
  };
}

export interface Example {
  readonly id: string;
  readonly title:
    | 'dashboards.exampleZermatt'
    | 'dashboards.exampleZermattCsv'
    | 'dashboards.exampleCansat'
    | 'dashboards.exampleVehicle';
  readonly dashboard: Dashboard;
}

export const EXAMPLES: readonly Example[] = [
  { id: 'vehicle', title: 'dashboards.exampleVehicle', dashboard: oneVehicle() },
  {
    id: 'zermatt',
    title: 'dashboards.exampleZermatt',
    dashboard: twoDrones('Two drones near Zermatt', ZERMATT_SOURCES, [mavlinkDrone(1), mavlinkDrone(2)]),
  },
  {
    id: 'zermatt-csv',
    title: 'dashboards.exampleZermattCsv',
    dashboard: twoDrones('Two drones near Zermatt (CSV)', ZERMATT_CSV_SOURCES, [
      csvDrone('north', 'North'),
      csvDrone('south', 'South'),
    ]),
  },
  { id: 'cansat', title: 'dashboards.exampleCansat', dashboard: cansat() },
];
