/** A small vehicle of its kind, turned by roll, pitch and yaw, seen from behind and above. */
import type { VehicleType } from '$lib/vehicle/Vehicle';

export interface Point3 {
  readonly x: number;
  readonly y: number;
  readonly z: number;
}

export interface Face {
  readonly points: readonly (readonly [number, number])[];
  /** 0 (dark) to 1 (light). */
  readonly light: number;
  readonly part: 'body' | 'left' | 'right' | 'fin';
}

type Corner = readonly [number, number, number];

/** Corners in the body: forward, right, down. */
type Model = readonly { readonly part: Face['part']; readonly corners: readonly Corner[] }[];

const PLANE: Model = [
  {
    part: 'left',
    corners: [
      [0.35, 0, 0],
      [-0.35, -1.1, 0.02],
      [-0.55, -1.1, 0.02],
      [-0.35, 0, 0],
    ],
  },
  {
    part: 'right',
    corners: [
      [0.35, 0, 0],
      [-0.35, 1.1, 0.02],
      [-0.55, 1.1, 0.02],
      [-0.35, 0, 0],
    ],
  },
  {
    part: 'left',
    corners: [
      [-0.75, 0, 0],
      [-1, -0.45, 0],
      [-1.1, -0.45, 0],
      [-1, 0, 0],
    ],
  },
  {
    part: 'right',
    corners: [
      [-0.75, 0, 0],
      [-1, 0.45, 0],
      [-1.1, 0.45, 0],
      [-1, 0, 0],
    ],
  },
  {
    part: 'fin',
    corners: [
      [-0.7, 0, 0],
      [-1.05, 0, -0.45],
      [-1.15, 0, -0.45],
      [-1.1, 0, 0],
    ],
  },
  {
    part: 'body',
    corners: [
      [1.2, 0, 0],
      [0.3, -0.14, 0],
      [-1.05, -0.05, 0],
      [-1.05, 0.05, 0],
      [0.3, 0.14, 0],
    ],
  },
  {
    part: 'body',
    corners: [
      [1.2, 0, 0],
      [0.3, -0.14, 0],
      [0.1, 0, -0.2],
    ],
  },
  {
    part: 'body',
    corners: [
      [1.2, 0, 0],
      [0.3, 0.14, 0],
      [0.1, 0, -0.2],
    ],
  },
  {
    part: 'body',
    corners: [
      [0.3, -0.14, 0],
      [-1.05, 0, -0.03],
      [0.1, 0, -0.2],
    ],
  },
  {
    part: 'body',
    corners: [
      [0.3, 0.14, 0],
      [-1.05, 0, -0.03],
      [0.1, 0, -0.2],
    ],
  },
];

/** Returns a rotor: a flat octagon. */
function rotor(forward: number, right: number, radius: number, down = -0.06): Model[number] {
  const corners = Array.from({ length: 8 }, (_, index): Corner => {
    const angle = (index * Math.PI) / 4;
    return [forward + radius * Math.cos(angle), right + radius * Math.sin(angle), down];
  });
  return { part: right < 0 ? 'left' : right > 0 ? 'right' : 'fin', corners };
}

/** Returns an arm of a frame from the middle to a rotor. */
function arm(forward: number, right: number): Model[number] {
  const side = Math.sign(forward * right) * 0.05;
  return {
    part: 'body',
    corners: [
      [0.05, -side, 0],
      [forward, right - side, 0],
      [forward, right + side, 0],
      [-0.05, side, 0],
    ],
  };
}

/** A body with a pointed nose, as long and as wide as is given; `down` is the height of its deck. */
function hull(length: number, width: number, deck: number): Model {
  const [nose, tail, side] = [length, -length, width];
  const top: Corner[] = [
    [nose, 0, deck],
    [nose * 0.5, side, deck],
    [tail, side, deck],
    [tail, -side, deck],
    [nose * 0.5, -side, deck],
  ];
  return [
    {
      part: 'right',
      corners: [
        [nose * 0.5, side, deck],
        [tail, side, deck],
        [tail, side * 0.7, 0.2],
        [nose * 0.5, side * 0.7, 0.2],
      ],
    },
    {
      part: 'left',
      corners: [
        [nose * 0.5, -side, deck],
        [tail, -side, deck],
        [tail, -side * 0.7, 0.2],
        [nose * 0.5, -side * 0.7, 0.2],
      ],
    },
    { part: 'body', corners: top },
    {
      part: 'fin',
      corners: [
        [nose * 0.3, 0, deck],
        [-nose * 0.1, 0, deck - 0.3],
        [-nose * 0.5, 0, deck],
      ],
    },
  ];
}

const ARMS: readonly (readonly [number, number])[] = [
  [0.75, -0.75],
  [0.75, 0.75],
  [-0.75, -0.75],
  [-0.75, 0.75],
];
const COPTER: Model = [
  ...ARMS.map(([forward, right]) => arm(forward, right)),
  ...ARMS.map(([forward, right]) => rotor(forward, right, 0.42)),
  {
    part: 'body',
    corners: [
      [0.5, 0, -0.05],
      [0.1, 0.22, -0.1],
      [-0.35, 0.18, -0.1],
      [-0.35, -0.18, -0.1],
      [0.1, -0.22, -0.1],
    ],
  },
];
const HELICOPTER: Model = [
  {
    part: 'body',
    corners: [
      [0.7, 0, 0.05],
      [0.2, 0.2, 0],
      [-1.2, 0.03, 0],
      [-1.2, -0.03, 0],
      [0.2, -0.2, 0],
    ],
  },
  {
    part: 'fin',
    corners: [
      [-1.05, 0, 0],
      [-1.2, 0, -0.4],
      [-1.3, 0, -0.4],
      [-1.25, 0, 0],
    ],
  },
  rotor(0, 0, 1, -0.3),
];
const VTOL: Model = [...PLANE, ...ARMS.map(([forward, right]) => rotor(forward * 0.7, right * 0.8, 0.26, -0.04))];
const VEHICLE: Model = hull(0.8, 0.5, -0.1);
const MODELS: Readonly<Partial<Record<VehicleType, Model>>> = {
  copter: COPTER,
  helicopter: HELICOPTER,
  plane: PLANE,
  vtol: VTOL,
  rover: VEHICLE,
  boat: hull(1.1, 0.42, -0.05),
  sub: hull(1.1, 0.25, -0.15),
};

const CAMERA_PITCH = (24 * Math.PI) / 180;
const DISTANCE = 4.2;

/** Returns a point of the body in the world (north, east, down); angles in radians. */
export function rotated([forward, right, down]: Corner, roll: number, pitch: number, yaw: number): Point3 {
  const y1 = right * Math.cos(roll) - down * Math.sin(roll);
  const z1 = right * Math.sin(roll) + down * Math.cos(roll);
  const x2 = forward * Math.cos(pitch) + z1 * Math.sin(pitch);
  const z2 = -forward * Math.sin(pitch) + z1 * Math.cos(pitch);
  return { x: x2 * Math.cos(yaw) - y1 * Math.sin(yaw), y: x2 * Math.sin(yaw) + y1 * Math.cos(yaw), z: z2 };
}

/** Returns the faces from the farthest to the nearest, in units of the picture: right and down from its centre. */
export function attitudeFaces(roll: number, pitch: number, yaw: number, type: VehicleType = 'unknown'): Face[] {
  const faces = (MODELS[type] ?? PLANE).map(({ part, corners }) => {
    const points = corners.map((corner) => rotated(corner, roll, pitch, yaw));
    return { part, light: lightOf(points), seen: points.map(project) };
  });
  const depth = (face: (typeof faces)[number]): number =>
    face.seen.reduce((sum, point) => sum + point[2], 0) / face.seen.length;
  return faces
    .sort((a, b) => depth(b) - depth(a))
    .map(({ part, light, seen }) => ({ part, light, points: seen.map(([x, y]) => [x, y] as const) }));
}

/** Returns right, down and depth of a point, seen towards north from behind and above. */
export function project({ x, y, z }: Point3): readonly [number, number, number] {
  const depth = DISTANCE + x * Math.cos(CAMERA_PITCH) + z * Math.sin(CAMERA_PITCH);
  const height = z * Math.cos(CAMERA_PITCH) - x * Math.sin(CAMERA_PITCH);
  return [(y * DISTANCE) / depth, (height * DISTANCE) / depth, depth];
}

function lightOf([a, b, c]: readonly Point3[]): number {
  const [u, v] = [minus(b!, a!), minus(c!, a!)];
  const normal = { x: u.y * v.z - u.z * v.y, y: u.z * v.x - u.x * v.z, z: u.x * v.y - u.y * v.x };
  const length = Math.hypot(normal.x, normal.y, normal.z) || 1;
  // Light from above, a little from the left and from behind.
  return Math.abs(normal.z * 0.9 + normal.y * 0.3 + normal.x * 0.3) / length;
}

function minus(a: Point3, b: Point3): Point3 {
  return { x: a.x - b.x, y: a.y - b.y, z: a.z - b.z };
}
