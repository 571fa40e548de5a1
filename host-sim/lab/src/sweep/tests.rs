//! Tests that cells equal runs of scenes from text, that all shards together equal the whole sweep, and that lines follow their
//! formulas.

use super::measure::Row;
use super::output::{self, Drawing};
use super::store::{CELLS, Shard, Store};
use super::{Sweep, gathered, lines, schema};
use crate::documented::is_documented;
use std::fs;
use std::path::{Path, PathBuf};
use touchstone_report::ProgramVersion;
use touchstone_report::plain_schema::misfit;
use touchstone_sim::scene::{Preset, Scene};

const COMMAND: &str = "touchstone sweep tap";
const STIFFNESS: &str = "wall.k_desired_n_m_per_rad=0.4..4:4";
const RATES: &str = "timing.rate_hz=500..2000:3:log";

fn base() -> Scene {
    Scene::load("tap")
        .and_then(|scene| scene.with_preset(Preset::Thesis))
        .and_then(|scene| scene.with_overrides(&["law.kind=spring", "timing.duration_s=0.5"]))
        .unwrap()
}

fn sweep(x: &str, y: &str) -> Sweep {
    let measures = ["k_displayed", "penetration_max"].map(str::to_owned);
    Sweep::new(
        &base(),
        [x, y],
        &measures,
        ProgramVersion::default(),
        COMMAND,
    )
    .unwrap()
}

fn folder(name: &str) -> PathBuf {
    let folder =
        std::env::temp_dir().join(format!("touchstone-sweep-{}-{name}", std::process::id()));
    let _ = fs::remove_dir_all(&folder);
    folder
}

/// Computes a shard and writes its folder; returns the number of cells that were computed.
fn made(sweep: &Sweep, shard: Shard, folder: &Path) -> u64 {
    let mut store = Store::open(folder, sweep, false).unwrap();
    let filled = sweep.fill(&mut store, shard, |_| ()).unwrap();
    output::write(
        sweep,
        shard,
        &store.cells,
        &Drawing::default(),
        folder,
        false,
    )
    .unwrap();
    store.close();
    filled.computed
}

/// Names and bytes of all files in a folder.
fn contents(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut files: Vec<(String, Vec<u8>)> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap())
        .map(|entry| {
            (
                entry.file_name().into_string().unwrap(),
                fs::read(entry.path()).unwrap(),
            )
        })
        .collect();
    files.sort();
    files
}

#[test]
fn a_cell_is_the_scene_that_its_values_make_as_text() {
    for (x, y) in [
        (STIFFNESS, RATES),
        (
            "device.friction.kinetic_n_m=1e-4..1e-2:3:log",
            "encoder.counts_per_rev=1000,40000",
        ),
        (
            "law.kind=spring,fba,enhanced-sfa",
            "operator.grip=light,firm",
        ),
        (
            "operator.hand.pad_damping_n_m_s_per_rad=0..2e-4:3",
            "law.guard.on=true,false",
        ),
    ] {
        let sweep = sweep(x, y);
        let grid = &sweep.grid;
        let mut scenes = grid.scenes();
        for cell in 0..grid.cells() {
            let (column, row) = grid.place(cell);
            let set = |axis: &super::axis::Axis, index| {
                format!("{}={}", axis.field.path, axis.text(index))
            };
            let by_text = base()
                .with_overrides(&[set(&grid.x, column), set(&grid.y, row)])
                .unwrap();
            assert_eq!(scenes.of_cell(cell).unwrap(), by_text, "{x} {y} {cell}");
        }
    }
}

#[test]
fn the_documented_schema_is_this_one_and_results_obey_it() {
    is_documented("sweep.schema.json", &schema::schema());
    for (x, y) in [(STIFFNESS, RATES), ("law.kind=spring,fba", RATES)] {
        let sweep = sweep(x, y);
        let out = folder(&format!("schema-{}", sweep.grid.cells()));
        made(&sweep, Shard { index: 1, of: 2 }, &out);
        let text = fs::read_to_string(out.join("results.json")).unwrap();
        let value = serde_json::from_str(&text).unwrap();
        assert_eq!(misfit(&schema::schema(), &value, ""), None);
        fs::remove_dir_all(&out).unwrap();
    }
}

#[test]
fn whole_and_in_shards_are_the_same_bytes() {
    let sweep = sweep(STIFFNESS, RATES);
    let whole = folder("whole");
    assert_eq!(made(&sweep, Shard::WHOLE, &whole), 12);
    let shards: Vec<PathBuf> = (1..=3)
        .map(|index| {
            let part = folder(&format!("part-{index}"));
            assert_eq!(made(&sweep, Shard { index, of: 3 }, &part), 4);
            part
        })
        .collect();
    let missing = gathered(&shards[1..], ProgramVersion::default()).unwrap_err();
    assert!(missing.to_string().contains("4 of 12 cells"), "{missing}");
    let (again, cells) = gathered(&shards, ProgramVersion::default()).unwrap();
    let merged = folder("merged");
    let store = Store::open(&merged, &again, false).unwrap();
    output::write(
        &again,
        Shard::WHOLE,
        &cells,
        &Drawing::default(),
        &merged,
        false,
    )
    .unwrap();
    store.close();
    let (whole_files, merged_files) = (contents(&whole), contents(&merged));
    let names = |files: &[(String, Vec<u8>)]| -> Vec<String> {
        files.iter().map(|(name, _)| name.clone()).collect()
    };
    assert_eq!(
        names(&whole_files),
        [
            "cells.csv",
            "cells.csv-metadata.json",
            "cells.parquet",
            "map-k-displayed.svg",
            "map-penetration-max.svg",
            "map-verdict.svg",
            "results.json",
            "scene.toml",
            "sweep.json"
        ]
    );
    assert_eq!(names(&whole_files), names(&merged_files));
    for ((name, a), (_, b)) in whole_files.iter().zip(&merged_files) {
        assert!(a == b, "{name} differs");
    }
    let other = Sweep::new(
        &base(),
        [STIFFNESS, "timing.rate_hz=500..2000:2"],
        &[],
        ProgramVersion::default(),
        COMMAND,
    )
    .unwrap();
    let stranger = folder("stranger");
    made(&other, Shard::WHOLE, &stranger);
    let refused = gathered(
        &[shards[0].clone(), stranger.clone()],
        ProgramVersion::default(),
    )
    .unwrap_err();
    assert!(
        refused.to_string().contains("of another sweep")
            && refused.to_string().contains("y, measures"),
        "{refused}"
    );
    for folder in shards.iter().chain([&whole, &merged, &stranger]) {
        fs::remove_dir_all(folder).unwrap();
    }
}

#[test]
fn what_was_ended_goes_on_and_no_cell_is_computed_twice() {
    let sweep = sweep(STIFFNESS, RATES);
    let whole = folder("uninterrupted");
    made(&sweep, Shard::WHOLE, &whole);
    let ended = folder("ended");
    let mut store = Store::open(&ended, &sweep, false).unwrap();
    sweep
        .fill(&mut store, Shard { index: 2, of: 3 }, |_| ())
        .unwrap();
    drop(store);
    // The file that a program leaves behind if it is ended in the middle of a line.
    let journal = ended.join("journal.csv");
    let mut text = fs::read_to_string(&journal).unwrap();
    let lines = text.lines().count();
    assert_eq!(lines, 1 + 4);
    text.truncate(text.len() - 5);
    fs::write(&journal, text).unwrap();
    assert_eq!(made(&sweep, Shard::WHOLE, &ended), 12 - 3);
    assert_eq!(contents(&ended), contents(&whole));
    assert_eq!(made(&sweep, Shard::WHOLE, &ended), 0);
    assert_eq!(contents(&ended), contents(&whole));
    let other = self::sweep(RATES, STIFFNESS);
    let refused = Store::open(&ended, &other, false).unwrap_err();
    assert!(
        refused.to_string().contains("holds another sweep: x, y"),
        "{refused}"
    );
    let store = Store::open(&ended, &other, true).unwrap();
    assert!(store.cells.is_empty());
    drop(store);
    for folder in [&whole, &ended] {
        fs::remove_dir_all(folder).unwrap();
    }
}

#[test]
fn a_scene_that_contradicts_itself_is_a_refused_cell() {
    let sweep = sweep(
        "device.friction.kinetic_n_m=1e-3,3e-3",
        "device.friction.static_n_m=2e-3,4e-3",
    );
    let mut scenes = sweep.grid.scenes();
    let mut verdicts = Vec::new();
    for cell in 0..4 {
        let (Row(_, _, _, verdict, values), refusal) = sweep.cell(&mut scenes, cell);
        assert_eq!(verdict == "refused", refusal.is_some());
        assert!(refusal.is_none() || values.iter().all(Option::is_none));
        verdicts.push(verdict);
    }
    let refused: Vec<bool> = verdicts
        .iter()
        .map(|verdict| verdict == "refused")
        .collect();
    assert_eq!(refused, [false, true, false, false]);
}

#[test]
fn lines_lie_where_their_formulas_say() {
    let rates = "timing.rate_hz=250..4000:5:log";
    let sweep = sweep("wall.k_desired_n_m_per_rad=0.1..10:5:log", rates);
    let counted = std::sync::Mutex::new(Vec::new());
    let note = |done, total| counted.lock().unwrap().push((done, total));
    let found = lines::all(&sweep.grid, true, &note);
    let counted = counted.into_inner().unwrap();
    let last = counted.iter().max().copied().unwrap();
    assert_eq!((last.0, counted.len() as u64), (last.1, last.1));
    let names: Vec<&str> = found.iter().map(|line| line.name).collect();
    assert_eq!(names[0], "k_c = c_i/(T/2 + t_d)");
    assert_eq!(names.last(), Some(&"certified stable within"));
    let c_i = base().law.device_damping_n_m_s_per_rad;
    assert!(found[0].pieces.len() > 20);
    for &(x, y) in found[0].pieces.iter().flatten() {
        let (stiffness, rate) = (10.0_f64.powf(x), 10.0_f64.powf(y));
        // A rate is a whole number of hertz.
        let off = (stiffness / (2.0 * c_i * rate) - 1.0).abs();
        assert!(off < 0.5 / rate + 1e-3, "{stiffness} at {rate}: {off}");
    }
}

#[test]
fn axes_that_are_none_are_refused_with_what_to_write() {
    let refused = |x: &str| {
        Sweep::new(&base(), [x, RATES], &[], ProgramVersion::default(), COMMAND)
            .unwrap_err()
            .to_string()
    };
    for (x, part) in [
        ("wall.k_desired_n_m_per_rad", "no values"),
        ("wall.k_desired_n_m_per_rad=1..2", "no count"),
        ("wall.k_desired_n_m_per_rad=0..2:5:log", "has no 0"),
        ("wall.k_desired_n_m_per_rad=2..1:5", "do not rise"),
        ("wall.k_desired_n_m_per_rad=-1..1:5", "is not a value of"),
        ("timing.rate_hz=1000..1002:9", "comes twice"),
        ("law.kind=spring,springs", "is not a value of"),
        ("law.kind=1..2:3", "no range of numbers"),
        ("timing.rate_hz=1000,2000", "other axis' field"),
        ("wall.k_desird_n_m_per_rad=1..2:3", "did you mean"),
    ] {
        let said = refused(x);
        assert!(said.contains(part), "{x}: {said}");
    }
}

#[test]
fn the_parquet_file_has_the_cells() {
    use ::parquet::file::reader::{FileReader, SerializedFileReader};
    use ::parquet::record::RowAccessor;
    let sweep = sweep("law.kind=spring,fba", STIFFNESS);
    let out = folder("parquet");
    made(&sweep, Shard::WHOLE, &out);
    let file = SerializedFileReader::new(fs::File::open(out.join("cells.parquet")).unwrap());
    let file = file.unwrap();
    let meta = file
        .metadata()
        .file_metadata()
        .key_value_metadata()
        .unwrap();
    assert!(
        meta.iter()
            .any(|pair| pair.key == "command" && pair.value.as_deref() == Some(COMMAND))
    );
    let text = fs::read_to_string(out.join(CELLS)).unwrap();
    let rows: Vec<String> = file
        .get_row_iter(None)
        .unwrap()
        .map(|row| {
            let row = row.unwrap();
            format!(
                "{},{},{},{}",
                row.get_double(0).unwrap(),
                row.get_string(1).unwrap(),
                row.get_double(2).unwrap(),
                row.get_string(3).unwrap()
            )
        })
        .collect();
    assert_eq!(rows.len(), 8);
    for (row, line) in rows.iter().zip(text.lines().skip(1)) {
        let line = line.replace(".0,", ",");
        assert!(line.starts_with(row.as_str()), "{line} {row}");
    }
    fs::remove_dir_all(&out).unwrap();
}
