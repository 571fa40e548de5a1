//! The cells of a map and the scene of each cell. A cell's scene is the base scene with two values replaced, without parsing text.

use super::axis::Axis;
use serde::Deserialize as _;
use serde_json::Value;
use touchstone_sim::error::{Error, Result};
use touchstone_sim::scene::Scene;

/// The cells of a map: a base scene and two axes.
#[derive(Debug, Clone)]
pub struct Grid {
    /// Horizontal axis of the map.
    pub x: Axis,
    /// Vertical axis of the map.
    pub y: Axis,
    /// The base scene, whose fields vary from cell to cell.
    pub base: Scene,
    /// The base scene as JSON: one entry if the values of both axes are numbers, else one for each combination of words.
    trees: Vec<Value>,
    leaves: [String; 2],
}

impl Grid {
    /// Makes the grid from a scene and two axes.
    ///
    /// # Errors
    /// Both axes have the same field, one axis removes the other's field, or the scene accepts none of the values that are tried.
    pub fn of(base: &Scene, x: Axis, y: Axis) -> Result<Self> {
        if x.field == y.field {
            return Err(Error::Option {
                option: y.asked.clone(),
                problem: "is the other axis' field".to_owned(),
                fix: "give two fields".to_owned(),
            });
        }
        let leaves = [&x, &y].map(|axis| format!("/{}", axis.field.path.replace('.', "/")));
        let mut grid = Self {
            x,
            y,
            base: base.clone(),
            trees: Vec::new(),
            leaves,
        };
        for word_y in 0..words(&grid.y) {
            for word_x in 0..words(&grid.x) {
                let tree = grid.tree(word_x, word_y)?;
                grid.trees.push(tree);
            }
        }
        Ok(grid)
    }

    /// The base scene as JSON with one word of each axis. On an axis of numbers the first value that the scene accepts is used.
    fn tree(&self, word_x: usize, word_y: usize) -> Result<Value> {
        let mut refused = None;
        for index_x in trials(&self.x, word_x) {
            for index_y in trials(&self.y, word_y) {
                let with = |scene: &Scene,
                            axis: &Axis,
                            index: usize|
                 -> std::result::Result<Scene, Error> {
                    scene.with_option(axis.field.path, &axis.text(index), &axis.asked)
                };
                let scene = with(&self.base, &self.x, index_x)
                    .and_then(|scene| with(&scene, &self.y, index_y));
                match scene {
                    Ok(scene) => {
                        let tree = serde_json::to_value(&scene).unwrap_or_default();
                        for (leaf, axis) in self.leaves.iter().zip([&self.x, &self.y]) {
                            if tree.pointer(leaf).is_none() {
                                return Err(Error::Option {
                                    option: axis.asked.clone(),
                                    problem: "the other axis removes this field".to_owned(),
                                    fix: "vary one of the two".to_owned(),
                                });
                            }
                        }
                        return Ok(tree);
                    }
                    Err(error) => refused = refused.or(Some(error)),
                }
            }
        }
        Err(refused.unwrap_or_else(|| Error::Option {
            option: self.x.asked.clone(),
            problem: "has no values".to_owned(),
            fix: "give some".to_owned(),
        }))
    }

    /// Number of cells of the map.
    #[must_use]
    pub fn cells(&self) -> u64 {
        (self.x.values.len() * self.y.values.len()) as u64
    }

    /// Column and row of a cell. Cells are numbered row by row, from the first value of y on.
    #[must_use]
    pub fn place(&self, cell: u64) -> (usize, usize) {
        let wide = self.x.values.len();
        ((cell as usize) % wide, (cell as usize) / wide)
    }

    /// Makes an object that builds the scenes of cells; each thread needs its own.
    #[must_use]
    pub fn scenes(&self) -> Scenes<'_> {
        Scenes {
            grid: self,
            trees: self.trees.clone(),
        }
    }
}

fn words(axis: &Axis) -> usize {
    match axis.numbers() {
        Some(_) => 1,
        None => axis.values.len(),
    }
}

/// Indices of an axis' values that are tried in the base scene: three values on an axis of numbers, else the value with the index
/// `word`.
fn trials(axis: &Axis, word: usize) -> Vec<usize> {
    match axis.numbers() {
        Some(_) => {
            let last = axis.values.len() - 1;
            vec![0, last, last / 2]
        }
        None => vec![word],
    }
}

/// Builds the scene of each cell from the base scene.
#[derive(Debug)]
pub struct Scenes<'a> {
    grid: &'a Grid,
    trees: Vec<Value>,
}

impl Scenes<'_> {
    /// The scene of a cell.
    ///
    /// # Errors
    /// Two values contradict each other, for example a break-away torque below the kinetic one.
    pub fn of_cell(&mut self, cell: u64) -> Result<Scene> {
        let (column, row) = self.grid.place(cell);
        let values = [
            self.grid.x.values[column].clone(),
            self.grid.y.values[row].clone(),
        ];
        self.with(values, [column, row])
    }

    /// The scene for numbers between those of the cells. `None` if an axis has words, or if values of the scene contradict each
    /// other.
    pub fn between(&mut self, x: f64, y: f64) -> Option<Scene> {
        self.grid.x.numbers()?;
        self.grid.y.numbers()?;
        let values = [self.grid.x.leaf(x), self.grid.y.leaf(y)];
        self.with(values, [0, 0]).ok()
    }

    fn with(&mut self, values: [Value; 2], [column, row]: [usize; 2]) -> Result<Scene> {
        let grid = self.grid;
        let of = |axis: &Axis, index: usize| if words(axis) == 1 { 0 } else { index };
        let tree = of(&grid.y, row) * words(&grid.x) + of(&grid.x, column);
        let tree = &mut self.trees[tree];
        for (leaf, value) in grid.leaves.iter().zip(values) {
            if let Some(place) = tree.pointer_mut(leaf) {
                *place = value;
            }
        }
        let scene = Scene::deserialize(&*tree).map_err(|error| {
            grid.base
                .error("", error.to_string(), "report this as a bug")
        })?;
        match scene.contradiction() {
            Some(error) => Err(error),
            None => Ok(scene),
        }
    }
}
