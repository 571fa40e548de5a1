//! Measures the computing time per tick (control period) of a mesh's proxy, the point that follows the hand on the surface. The
//! meshes are balls of 20 mm radius with more and more triangles. The hand moves around the ball 0.4 mm inside the surface, then
//! 0.4 mm outside.

#[path = "../tests/shapes/mod.rs"]
mod shapes;

use shapes::{ball, mm};
use std::hint::black_box;
use std::time::Instant;
use touchstone_mesh::Proxy;

fn main() {
    println!(
        "{:>10}  {:>12}  {:>12}",
        "triangles", "inside ns", "outside ns"
    );
    for rings in [16, 32, 46, 90] {
        let mesh = ball(20.0, rings).mesh();
        let tick = |radius: f64| {
            let course: Vec<_> = (0..20_000)
                .map(|i| 1e-3 * f64::from(i))
                .map(|t: f64| {
                    radius
                        * mm(
                            t.cos() * (0.3 * t).cos(),
                            t.sin() * (0.3 * t).cos(),
                            (0.3 * t).sin(),
                        )
                })
                .collect();
            let mut best = f64::INFINITY;
            for _ in 0..5 {
                let mut proxy = Proxy::new(&mesh, 2.0 * course[0]);
                let start = Instant::now();
                for hand in &course {
                    black_box(proxy.follow(&mesh, *hand));
                }
                best = best.min(start.elapsed().as_secs_f64() / course.len() as f64);
            }
            1e9 * best
        };
        println!(
            "{:>10}  {:>12.0}  {:>12.0}",
            mesh.triangles(),
            tick(19.6),
            tick(20.4)
        );
    }
}
