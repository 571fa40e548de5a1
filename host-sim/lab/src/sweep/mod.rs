//! Computes maps: two settings of a scene vary (a sweep), and every cell of the map has the results of its run.
//!
//! [`axis`] and [`grid`] build the cells' scenes, [`measure`] has the results to store. [`store`] keeps the cells in a folder, so
//! that an interrupted sweep can continue and shards can be combined. [`lines`] computes what theory predicts in the same plane,
//! [`map`] draws cells and lines, [`output`] writes all files. A cell depends only on its scene, so files are the same, byte for
//! byte, for any number of threads, shards or interruptions.

pub mod axis;
pub mod grid;
pub mod lines;
pub mod map;
pub mod measure;
pub mod output;
pub mod schema;
pub mod store;
#[cfg(test)]
mod tests;

use axis::Axis;
use grid::Grid;
use measure::{Measure, Row};
use rayon::prelude::*;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use store::{Shard, Store};
use touchstone_report::ProgramVersion;
use touchstone_report::origin::{SCHEMA_VERSION, sha256};
use touchstone_sim::error::{Error, Result};
use touchstone_sim::run;
use touchstone_sim::scene::{MotionSpec, Scene};

/// Time between two writes of finished cells. An interruption loses at most the work of this time.
const PIECE: Duration = Duration::from_millis(500);

/// A sweep: the cells of a map, and the measures that are stored for each.
#[derive(Debug, Clone)]
pub struct Sweep {
    /// The cells of the map and their scenes.
    pub grid: Grid,
    /// Measures that are stored for each cell besides its verdict.
    pub measures: Vec<Measure>,
    /// Version of the program.
    pub program: ProgramVersion,
    /// Command that computes the whole map, without options on folders, shards and threads.
    pub command: String,
    /// Files that the scene reads, with their hashes.
    inputs: Vec<Value>,
}

impl Sweep {
    /// Makes a sweep; `x` and `y` are axes in the form of the command line.
    ///
    /// # Errors
    /// An axis does not fit the scene, a measure is unknown, or a recording cannot be read.
    pub fn new(
        scene: &Scene,
        [x, y]: [&str; 2],
        measures: &[String],
        program: ProgramVersion,
        command: &str,
    ) -> Result<Self> {
        let x = Axis::parse("--x", x, scene)?;
        let y = Axis::parse("--y", y, scene)?;
        let mut inputs = Vec::new();
        if let MotionSpec::Recorded(recorded) = &scene.operator.motion {
            let content = touchstone_sim::input::bytes(
                &recorded.file,
                touchstone_sim::input::MOST_OF_RECORDING,
            )
            .map_err(|error| Error::Io {
                path: recorded.file.clone(),
                problem: error.to_string(),
                fix: "give a recording that can be read".to_owned(),
            })?;
            inputs.push(
                json!({"path": recorded.file, "sha256": sha256(&content), "bytes": content.len()}),
            );
        }
        Ok(Self {
            grid: Grid::of(scene, x, y)?,
            measures: measure::named(measures)?,
            program,
            command: command.to_owned(),
            inputs,
        })
    }

    /// All values on which the cells depend, and the command, as JSON.
    #[must_use]
    pub fn plan(&self) -> Value {
        let axis =
            |axis: &Axis| json!({"field": axis.field.path, "log": axis.log, "values": axis.values});
        json!({
            "schema_version": SCHEMA_VERSION,
            "program": self.program,
            "command": self.command,
            "scene": self.grid.base,
            "inputs": self.inputs,
            "x": axis(&self.grid.x),
            "y": axis(&self.grid.y),
            "measures": self.measures.iter().map(|measure| measure.name).collect::<Vec<_>>(),
        })
    }

    /// Names of the columns in the table of cells.
    #[must_use]
    pub fn header(&self) -> Vec<String> {
        let mut names = vec![
            "cell".to_owned(),
            self.grid.x.field.path.to_owned(),
            self.grid.y.field.path.to_owned(),
            measure::VERDICT.to_owned(),
        ];
        names.extend(self.measures.iter().map(measure::Measure::column));
        names
    }

    /// Computes one cell. If the cell is refused, the error is returned as well.
    pub fn cell(&self, scenes: &mut grid::Scenes<'_>, cell: u64) -> (Row, Option<Error>) {
        let (column, row) = self.grid.place(cell);
        let place = [self.grid.x.text(column), self.grid.y.text(row)];
        match scenes
            .of_cell(cell)
            .and_then(|scene| run::run(&scene, false))
        {
            Ok(run) => (Row::of(cell, place, Some(&run), &self.measures), None),
            Err(error) => (Row::of(cell, place, None, &self.measures), Some(error)),
        }
    }

    /// Computes the missing cells of a shard in parallel, and stores them. Calls `told` with the number of the shard's finished
    /// cells.
    ///
    /// # Errors
    /// The folder cannot be written.
    pub fn fill(
        &self,
        store: &mut Store,
        shard: Shard,
        mut told: impl FnMut(u64),
    ) -> Result<Filled> {
        let own: Vec<u64> = (0..self.grid.cells())
            .filter(|cell| shard.has(*cell))
            .collect();
        let todo: Vec<u64> = own
            .iter()
            .copied()
            .filter(|cell| !store.cells.contains_key(cell))
            .collect();
        let mut filled = Filled {
            before: (own.len() - todo.len()) as u64,
            computed: 0,
            refusal: None,
        };
        told(filled.before);
        let mut piece = 4 * rayon::current_num_threads();
        let mut rest = &todo[..];
        while !rest.is_empty() {
            let (now, later) = rest.split_at(piece.min(rest.len()));
            let begun = Instant::now();
            let done: Vec<(Row, Option<Error>)> = now
                .par_iter()
                .map_init(
                    || self.grid.scenes(),
                    |scenes, cell| self.cell(scenes, *cell),
                )
                .collect();
            let mut rows = Vec::with_capacity(done.len());
            for (row, refusal) in done {
                if let Some(error) = refusal {
                    let cell = row.0;
                    filled.refusal.get_or_insert((cell, error));
                }
                rows.push(row);
            }
            store.keep(rows)?;
            filled.computed += now.len() as u64;
            told(filled.before + filled.computed);
            rest = later;
            // The number of cells per batch is adjusted so that a batch takes the intended time, by at most a factor of four.
            let took = begun.elapsed().as_secs_f64().max(1e-6);
            let factor = (PIECE.as_secs_f64() / took).clamp(0.25, 4.0);
            piece = ((piece as f64 * factor) as usize).max(rayon::current_num_threads());
        }
        Ok(filled)
    }
}

/// Result of [`Sweep::fill`]: numbers of cells, and the first refused cell.
#[derive(Debug, Clone, PartialEq)]
pub struct Filled {
    /// Number of cells that the folder already held.
    pub before: u64,
    /// Number of cells that this call computed.
    pub computed: u64,
    /// Number of the first cell that was refused in this call, and the error.
    pub refusal: Option<(u64, Error)>,
}

/// Reads a sweep with its cells from the folders of its shards. The description of the sweep is taken from the first folder.
///
/// # Errors
/// A folder has no sweep, the folders belong to different sweeps or to another program version, or cells are missing.
pub fn gathered(folders: &[PathBuf], program: ProgramVersion) -> Result<(Sweep, store::Cells)> {
    let mut first: Option<(Value, &Path)> = None;
    let mut cells = store::Cells::new();
    for folder in folders {
        let refuse = |problem: String, fix: &str| {
            Err(Error::Io {
                path: folder.clone(),
                problem,
                fix: fix.to_owned(),
            })
        };
        let Some(plan) = store::plan_of(folder)? else {
            return refuse(
                "holds no sweep".to_owned(),
                "give folders that `touchstone sweep … --out` made",
            );
        };
        match &first {
            None => first = Some((plan, folder)),
            Some((other, place)) if !store::same(other, &plan) => {
                return refuse(
                    format!(
                        "is of another sweep than {}: {}",
                        place.display(),
                        store::difference(other, &plan)
                    ),
                    "give the parts of one sweep",
                );
            }
            Some(_) => {}
        }
        cells.extend(store::read_all(folder)?);
    }
    let Some((plan, place)) = first else {
        return Err(Error::Option {
            option: "merge".to_owned(),
            problem: "no folders".to_owned(),
            fix: "give the folders of the parts".to_owned(),
        });
    };
    let sweep = Sweep::of_plan(&plan, place, program)?;
    let missing = sweep.grid.cells() - (cells.len() as u64).min(sweep.grid.cells());
    if missing > 0 {
        return Err(Error::Io {
            path: place.to_owned(),
            problem: format!(
                "{missing} of {} cells are in none of these folders",
                sweep.grid.cells()
            ),
            fix: "let every part finish, and name all folders".to_owned(),
        });
    }
    Ok((sweep, cells))
}

impl Sweep {
    fn of_plan(plan: &Value, place: &Path, program: ProgramVersion) -> Result<Self> {
        let wrong = |problem: String| Error::Io {
            path: place.join(store::PLAN),
            problem,
            fix: "run the parts again with this program".to_owned(),
        };
        let scene: Scene = serde_json::from_value(plan["scene"].clone())
            .map_err(|error| wrong(error.to_string()))?;
        let axis = |name: &str| -> Result<Axis> {
            let of = &plan[name];
            let texts = of["values"].as_array().map(|values| {
                let text = |value: &Value| {
                    value
                        .as_str()
                        .map_or_else(|| value.to_string(), str::to_owned)
                };
                values.iter().map(text).collect::<Vec<_>>().join(",")
            });
            let text = format!(
                "{}={}",
                of["field"].as_str().unwrap_or_default(),
                texts.unwrap_or_default()
            );
            let mut axis = Axis::parse(&format!("--{name}"), &text, &scene)?;
            axis.log = of["log"].as_bool().unwrap_or_default();
            Ok(axis)
        };
        let names: Vec<String> =
            serde_json::from_value(plan["measures"].clone()).unwrap_or_default();
        let sweep = Self {
            grid: Grid::of(&scene, axis("x")?, axis("y")?)?,
            measures: measure::named(&names)?,
            program,
            command: plan["command"].as_str().unwrap_or_default().to_owned(),
            inputs: plan["inputs"].as_array().cloned().unwrap_or_default(),
        };
        let difference = store::difference(plan, &sweep.plan());
        if difference.is_empty() {
            Ok(sweep)
        } else {
            Err(wrong(format!("was made by another program: {difference}")))
        }
    }
}

/// Sets the number of threads that simulate runs.
///
/// # Errors
/// The threads cannot be started, or were started before.
pub fn use_threads(threads: usize) -> std::result::Result<(), String> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build_global()
        .map_err(|error| error.to_string())
}
