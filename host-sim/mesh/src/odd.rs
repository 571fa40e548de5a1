//! Checks a mesh for likely mistakes and warns of them: triangles inside out, doubled triangles, an open surface, an object out of
//! reach, a wrong unit.

use super::mesh::Mesh;
use parry3d_f64::math::Vector;
use std::collections::HashMap;

/// Diagonal of the bounding box below which a mesh is probably in another unit, m.
const LEAST_M: f64 = 1e-3;
/// Ratio of the mesh's diagonal to that of the device's workspace above which the mesh is probably in another unit.
const MOST_TIMES: f64 = 100.0;

/// Counts of irregular edges and triangles in a mesh.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Edges {
    /// Number of edges that belong to one triangle only; at such an edge the surface is open.
    pub open: usize,
    /// Number of edges along which two triangles run in the same direction: one of the two triangles is inside out.
    pub same_way: usize,
    /// Number of triangles with the same corners as another triangle, in any order; the first of such triangles is not counted.
    pub doubled: usize,
}

/// A part of a mesh: triangles connected by common corners.
struct Part {
    from: Vector,
    volume_m3: f64,
    least: Vector,
    most: Vector,
}

impl Part {
    fn is_around(&self, other: &Self) -> bool {
        let [low, high] = [self.least, self.most].map(|at| at.to_array());
        let [least, most] = [other.least, other.most].map(|at| at.to_array());
        (0..3).all(|axis| low[axis] <= least[axis] && most[axis] <= high[axis])
    }
}

impl Mesh {
    /// Volume that the triangles of a closed mesh enclose, m³; negative if they are inside out.
    #[must_use]
    pub fn signed_volume_m3(&self) -> f64 {
        // Volumes are relative to a point of the mesh: relative to a far origin, rounding would cancel the result.
        let from = self
            .tree
            .corners()
            .next()
            .map_or(Vector::ZERO, |[first, ..]| first);
        let six = |corners: [Vector; 3]| {
            let [a, b, c] = corners.map(|corner| corner - from);
            a.dot(b.cross(c))
        };
        self.tree.corners().map(six).sum::<f64>() / 6.0
    }

    /// Number of the place of each vertex: vertices with equal coordinates have the same number.
    fn places(&self) -> Vec<u32> {
        let vertices = self.tree.vertices();
        // The coordinates -0 and 0 count as equal.
        let key = |&vertex: &u32| {
            let at = vertices[vertex as usize].to_array();
            at.map(|value| (value + 0.0).to_bits())
        };
        let mut order: Vec<u32> = (0..vertices.len() as u32).collect();
        order.sort_unstable_by_key(key);
        let mut places = vec![0; order.len()];
        let mut place = 0;
        for (at, vertex) in order.iter().enumerate() {
            if at > 0 && key(vertex) != key(&order[at - 1]) {
                place += 1;
            }
            places[*vertex as usize] = place;
        }
        places
    }

    /// Volume and bounding box of each connected part of the mesh. Different parts share no corner.
    fn parts(&self) -> Vec<Part> {
        let places = self.places();
        // Union-find: for each place a reference towards the first place of its part.
        let mut above: Vec<u32> = (0..places.len() as u32).collect();
        let root = |above: &mut [u32], mut at: u32| {
            while above[at as usize] != at {
                above[at as usize] = above[above[at as usize] as usize];
                at = above[at as usize];
            }
            at
        };
        for triangle in self.tree.triangles() {
            let corners = triangle.map(|corner| root(&mut above, places[corner as usize]));
            let least = corners.into_iter().min().unwrap_or(0);
            corners
                .into_iter()
                .for_each(|corner| above[corner as usize] = least);
        }
        let mut parts: HashMap<u32, Part> = HashMap::new();
        for (triangle, corners) in self.tree.triangles().iter().zip(self.tree.corners()) {
            let first = root(&mut above, places[triangle[0] as usize]);
            let part = parts.entry(first).or_insert(Part {
                from: corners[0],
                volume_m3: 0.0,
                least: corners[0],
                most: corners[0],
            });
            let [a, b, c] = corners.map(|corner| corner - part.from);
            part.volume_m3 += a.dot(b.cross(c)) / 6.0;
            for corner in corners {
                part.least = part.least.min(corner);
                part.most = part.most.max(corner);
            }
        }
        parts.into_values().collect()
    }

    /// Number of parts that are inside out, and number of all parts. A part counts as inside out if its volume is negative and it
    /// is not a cavity in another part.
    fn inside_out(&self) -> (usize, usize) {
        let parts = self.parts();
        let is_hollow = |part: &Part| {
            let around = |other: &&Part| other.volume_m3 > 0.0 && other.is_around(part);
            parts.iter().any(|other| around(&other))
        };
        let turned = parts
            .iter()
            .filter(|part| part.volume_m3 < 0.0 && !is_hollow(part));
        (turned.count(), parts.len())
    }

    /// Counts the irregular edges and triangles of the mesh.
    #[must_use]
    pub fn edges(&self) -> Edges {
        let places = self.places();
        let triangles = self.tree.triangles();
        let corners = |number: usize| triangles[number].map(|corner| places[corner as usize]);
        let mut found = Edges::default();
        // Sorted lists are used instead of hash tables, which would take hundreds of megabytes for a million triangles.
        let mut sorted: Vec<([u32; 3], u32)> = (0..triangles.len())
            .map(|number| {
                let mut corners = corners(number);
                corners.sort_unstable();
                (corners, number as u32)
            })
            .collect();
        sorted.sort_unstable();
        let mut is_doubled = vec![false; triangles.len()];
        for pair in sorted.windows(2) {
            let is_same = pair[0].0 == pair[1].0;
            is_doubled[pair[1].1 as usize] = is_same;
            found.doubled += usize::from(is_same);
        }
        drop(sorted);
        // Key of an edge: its two ends, the lesser first, and in the last bit the direction in which the triangle runs. The number
        // of a place has fewer than 31 bits.
        let mut ways: Vec<u64> = Vec::with_capacity(3 * triangles.len());
        for (number, _) in is_doubled
            .iter()
            .enumerate()
            .filter(|(_, doubled)| !**doubled)
        {
            let corners = corners(number);
            ways.extend((0..3).map(|at| {
                let (from, to) = (corners[at], corners[(at + 1) % 3]);
                u64::from(from.min(to)) << 33 | u64::from(from.max(to)) << 1 | u64::from(from < to)
            }));
        }
        ways.sort_unstable();
        for edge in ways.chunk_by(|one, other| one >> 1 == other >> 1) {
            let there = edge.iter().filter(|way| **way & 1 == 1).count();
            let back = edge.len() - there;
            found.open += usize::from(edge.len() == 1);
            // If more than two triangles meet at an edge, for example where solids touch, only the counts of both directions must
            // be equal. An odd number of triangles is not counted as irregular.
            found.same_way +=
                usize::from(edge.len() > 1 && there != back && edge.len().is_multiple_of(2));
        }
        found
    }

    /// The mesh's bounding box, m: smallest and largest coordinates.
    #[must_use]
    pub fn bounds_m(&self) -> [[f64; 3]; 2] {
        let around = self.tree.around();
        [around.mins.to_array(), around.maxs.to_array()]
    }

    /// Remarks on the mesh for the user, one per line. `workspace_m` is the box that the device reaches.
    #[must_use]
    pub fn notes(&self, workspace_m: [[f64; 3]; 2]) -> Vec<String> {
        let mut notes = Vec::new();
        let edges = self.edges();
        let volume = self.signed_volume_m3();
        if self.solids() > 1 {
            notes.push(format!(
                "the file has {} solids; all of them are used",
                self.solids()
            ));
        }
        if self.not_convex() > 0 {
            notes.push(format!(
                "{} of its faces are not convex, so their triangles overlap: export the object as triangles",
                self.not_convex()
            ));
        }
        if edges.doubled > 0 {
            notes.push(format!(
                "{} triangles lie on another one: parts of the mesh are doubled",
                edges.doubled
            ));
        }
        if edges.same_way > 0 {
            notes.push(format!(
                "{} edges run the same way in both triangles: some triangles are inside out and let the hand through",
                edges.same_way
            ));
        }
        if edges.open > 0 {
            notes.push(format!(
                "{} edges belong to one triangle only: the mesh is open, and only its front can be felt",
                edges.open
            ));
        } else if edges.same_way == 0 && volume < 0.0 {
            notes.push(format!(
                "its volume is {:.3} cm³: the mesh is inside out, so it cannot be felt from outside; flip its normals",
                1e6 * volume
            ));
        } else if edges.same_way == 0
            && let (turned @ 1.., parts) = self.inside_out()
        {
            notes.push(format!(
                "{turned} of its {parts} parts have a negative volume: they are inside out and cannot be felt from outside; flip their normals"
            ));
        }
        let [least, most] = self.bounds_m();
        let [low, high] = workspace_m;
        let reach_m = (Vector::from_array(high) - Vector::from_array(low)).length();
        let mm = |metres: [f64; 3]| metres.map(|value| format!("{:.1}", 1e3 * value)).join(", ");
        if self.size_m() < LEAST_M {
            notes.push(format!(
                "it is {:.4} mm across: check that --mesh-unit-m is the file's unit",
                1e3 * self.size_m()
            ));
        } else if (0..3).any(|axis| least[axis] > high[axis] || most[axis] < low[axis]) {
            notes.push(format!(
                "its box from ({}) to ({}) mm does not meet the device's workspace from ({}) to ({}) mm, so it cannot be felt; move the object, or give --mesh-unit-m",
                mm(least), mm(most), mm(low), mm(high)
            ));
        } else if (0..3).all(|axis| least[axis] < low[axis] && most[axis] > high[axis]) {
            notes.push(format!(
                "its box from ({}) to ({}) mm encloses the device's whole workspace: check that --mesh-unit-m is the file's unit",
                mm(least), mm(most)
            ));
        } else if self.size_m() > MOST_TIMES * reach_m {
            notes.push(format!(
                "it is {:.0} m across, but the device reaches only {reach_m:.3} m: check that --mesh-unit-m is the file's unit",
                self.size_m()
            ));
        }
        notes
    }
}
