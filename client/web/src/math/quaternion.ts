// Unit quaternions [w, x, y, z] and vectors [x, y, z]. Plain arrays: the same numbers go to the server.
export type Quaternion = readonly [number, number, number, number];
export type Vector3 = readonly [number, number, number];

export const kIdentity: Quaternion = [1, 0, 0, 0];

export const add = (a: Vector3, b: Vector3): Vector3 => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const subtract = (a: Vector3, b: Vector3): Vector3 => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const scale = (a: Vector3, s: number): Vector3 => [a[0] * s, a[1] * s, a[2] * s];
export const dot = (a: Vector3, b: Vector3): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a: Vector3, b: Vector3): Vector3 =>
  [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export const length = (a: Vector3): number => Math.hypot(a[0], a[1], a[2]);
export const unit = (a: Vector3): Vector3 => {
  const size = length(a);
  return size > 1e-12 ? scale(a, 1 / size) : [0, 0, 0];
};

export const multiply = (a: Quaternion, b: Quaternion): Quaternion => [
  a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
  a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
  a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
  a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
];
export const inverse = (q: Quaternion): Quaternion => [q[0], -q[1], -q[2], -q[3]];
export const normalize = (q: Quaternion): Quaternion => {
  const size = Math.hypot(q[0], q[1], q[2], q[3]);
  return size > 1e-12 ? [q[0] / size, q[1] / size, q[2] / size, q[3] / size] : kIdentity;
};
export const rotate = (q: Quaternion, v: Vector3): Vector3 => {
  const u: Vector3 = [q[1], q[2], q[3]];
  const t = scale(cross(u, v), 2);
  return add(add(v, scale(t, q[0])), cross(u, t));
};

// The shortest rotation that turns direction `a` to direction `b`.
export function between(a: Vector3, b: Vector3): Quaternion {
  const from = unit(a), to = unit(b);
  const cosine = dot(from, to);
  if (cosine < -1 + 1e-9) {  // half a turn about anything that is orthogonal
    const axis = unit(cross(from, Math.abs(from[0]) < .9 ? [1, 0, 0] : [0, 1, 0]));
    return [0, axis[0], axis[1], axis[2]];
  }
  const axis = cross(from, to);
  return normalize([1 + cosine, axis[0], axis[1], axis[2]]);
}

export function slerp(a: Quaternion, b: Quaternion, fraction: number): Quaternion {
  let cosine = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
  const sign = cosine < 0 ? -1 : 1;  // the shorter way
  cosine = Math.min(1, Math.abs(cosine));
  const angle = Math.acos(cosine);
  const sine = Math.sin(angle);
  const [p, q] = sine < 1e-6 ? [1 - fraction, sign * fraction]
    : [Math.sin((1 - fraction) * angle) / sine, sign * Math.sin(fraction * angle) / sine];
  return normalize([p * a[0] + q * b[0], p * a[1] + q * b[1], p * a[2] + q * b[2], p * a[3] + q * b[3]]);
}

const kDegrees = 180 / Math.PI;

// Angles about the fixed axes x, then y, then z, in degrees, and back.
export function toDegrees(q: Quaternion): Vector3 {
  const [w, x, y, z] = q;
  const sine = Math.max(-1, Math.min(1, 2 * (w * y - z * x)));
  if (Math.abs(sine) > 1 - 1e-9) return [0, Math.asin(sine) * kDegrees, -2 * Math.sign(sine) * Math.atan2(x, w) * kDegrees];
  return [Math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)) * kDegrees, Math.asin(sine) * kDegrees,
    Math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)) * kDegrees];
}
export function fromDegrees(angles: Vector3): Quaternion {
  const turn = (axis: 1 | 2 | 3, degrees: number): Quaternion => {
    const q: [number, number, number, number] = [Math.cos(degrees / 2 / kDegrees), 0, 0, 0];
    q[axis] = Math.sin(degrees / 2 / kDegrees);
    return q;
  };
  return normalize(multiply(turn(3, angles[2]), multiply(turn(2, angles[1]), turn(1, angles[0]))));
}
