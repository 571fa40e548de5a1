/** Two directions along a plane, at right angles to each other and to the plane's normal of length 1. */
function along(normal) {
  const [x, y, z] = normal, across = Math.hypot(z, x) > 1e-6 ? [z, 0, -x] : [1, 0, 0], length = Math.hypot(...across), a = across.map((n) => n / length);
  return [a, [y * a[2] - z * a[1], z * a[0] - x * a[2], x * a[1] - y * a[0]]];
}
