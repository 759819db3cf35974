/** A small aircraft, turned by roll, pitch and yaw, seen from behind and above. */
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
const FACES: readonly { readonly part: Face['part']; readonly corners: readonly Corner[] }[] = [
  { part: 'left', corners: [[0.35, 0, 0], [-0.35, -1.1, 0.02], [-0.55, -1.1, 0.02], [-0.35, 0, 0]] },
  { part: 'right', corners: [[0.35, 0, 0], [-0.35, 1.1, 0.02], [-0.55, 1.1, 0.02], [-0.35, 0, 0]] },
  { part: 'left', corners: [[-0.75, 0, 0], [-1, -0.45, 0], [-1.1, -0.45, 0], [-1, 0, 0]] },
  { part: 'right', corners: [[-0.75, 0, 0], [-1, 0.45, 0], [-1.1, 0.45, 0], [-1, 0, 0]] },
  { part: 'fin', corners: [[-0.7, 0, 0], [-1.05, 0, -0.45], [-1.15, 0, -0.45], [-1.1, 0, 0]] },
  { part: 'body', corners: [[1.2, 0, 0], [0.3, -0.14, 0], [-1.05, -0.05, 0], [-1.05, 0.05, 0], [0.3, 0.14, 0]] },
  { part: 'body', corners: [[1.2, 0, 0], [0.3, -0.14, 0], [0.1, 0, -0.2]] },
  { part: 'body', corners: [[1.2, 0, 0], [0.3, 0.14, 0], [0.1, 0, -0.2]] },
  { part: 'body', corners: [[0.3, -0.14, 0], [-1.05, 0, -0.03], [0.1, 0, -0.2]] },
  { part: 'body', corners: [[0.3, 0.14, 0], [-1.05, 0, -0.03], [0.1, 0, -0.2]] },
];
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
export function attitudeFaces(roll: number, pitch: number, yaw: number): Face[] {
  const faces = FACES.map(({ part, corners }) => {
    const points = corners.map((corner) => rotated(corner, roll, pitch, yaw));
    return { part, light: lightOf(points), seen: points.map(project) };
  });
  const depth = (face: (typeof faces)[number]): number => face.seen.reduce((sum, point) => sum + point[2], 0) / face.seen.length;
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
