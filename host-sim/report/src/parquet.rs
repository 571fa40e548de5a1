//! Writes a trace as a Parquet file, for pandas, polars, DuckDB and similar tools: columns of doubles, with units and the run's
//! summary in the metadata. Also writes any other table.

use std::io::{self, Write};
use std::sync::Arc;

use ::parquet::basic::{Compression, Encoding, LogicalType, Repetition, Type as Physical};
use ::parquet::data_type::{ByteArray, ByteArrayType, DoubleType};
use ::parquet::errors::ParquetError;
use ::parquet::file::metadata::KeyValue;
use ::parquet::file::properties::{WriterProperties, WriterPropertiesBuilder};
use ::parquet::file::writer::SerializedFileWriter;
use ::parquet::schema::types::{ColumnPath, PrimitiveTypeBuilder, Type};

use super::columns::{self, COLUMNS};
use touchstone_control::Choice;
use touchstone_sim::run::record::{Run, Trace};

/// Number of ticks in a row group: a minute at 1 kHz, about 6 MB before compression. Usual traces are one group; a long recording
/// can be read in parts.
const GROUP: usize = 60_000;

/// Writes the trace of `run`, every `every`th tick from the first on.
///
/// The file's metadata are `scene`, `law`, `summary` (the run's entry in `results.json`), `units` (unit per column), `columns`
/// (meaning per column), then `more`. `summary`, `units` and `columns` are JSON. A missing value is NaN, not null, so that columns
/// stay plain vectors.
///
/// # Errors
/// The operating system's error if writing failed.
pub fn write(
    out: impl Write + Send,
    run: &Run,
    trace: &Trace,
    every: usize,
    more: &[(&str, String)],
) -> io::Result<()> {
    write_file(out, run, trace, every.max(1), more).map_err(|error| match error {
        // The operating system's error is wrapped; its kind decides about the advice to the user.
        ParquetError::External(inner) => match inner.downcast::<io::Error>() {
            Ok(error) => *error,
            Err(other) => io::Error::other(other),
        },
        other => io::Error::other(other),
    })
}

fn write_file(
    out: impl Write + Send,
    run: &Run,
    trace: &Trace,
    every: usize,
    more: &[(&str, String)],
) -> Result<(), ParquetError> {
    let fields = COLUMNS
        .iter()
        .map(|column| numbers(column.name))
        .collect::<Result<Vec<_>, _>>()?;
    let schema = Type::group_type_builder("trace")
        .with_fields(fields)
        .build()?;
    let mut file =
        SerializedFileWriter::new(out, Arc::new(schema), Arc::new(properties(run, more)))?;
    let len = columns::len(trace);
    // An empty trace gets no row group. The file still has its columns and can be read.
    for start in (0..len).step_by(GROUP * every) {
        let end = len.min(start + GROUP * every);
        let mut group = file.next_row_group()?;
        for column in COLUMNS {
            let mut writer = group.next_column()?.expect("as many columns as the schema");
            let values = &(column.values)(trace)[start..end];
            let thinned: Vec<f64>;
            let values = if every == 1 {
                values
            } else {
                thinned = values.iter().copied().step_by(every).collect();
                &thinned
            };
            writer
                .typed::<DoubleType>()
                .write_batch(values, None, None)?;
            writer.close()?;
        }
        group.close()?;
    }
    file.close()?;
    Ok(())
}

fn properties(run: &Run, more: &[(&str, String)]) -> WriterProperties {
    let map = |value: fn(&columns::Column) -> &'static str| {
        let map: serde_json::Map<_, _> = COLUMNS
            .iter()
            .map(|c| (c.name.to_owned(), value(c).into()))
            .collect();
        serde_json::Value::Object(map).to_string()
    };
    let summary = serde_json::to_string(&run.summary)
        .expect("a summary has only string keys and plain values");
    let entries = [
        ("scene", run.summary.scene.clone()),
        ("law", run.summary.law.word().to_owned()),
        ("summary", summary),
        ("units", map(|column| column.unit)),
        ("columns", map(|column| column.meaning)),
    ];
    builder(entries.into_iter().chain(more.iter().cloned())).build()
}

fn builder<'a>(metadata: impl Iterator<Item = (&'a str, String)>) -> WriterPropertiesBuilder {
    WriterProperties::builder()
        .set_created_by(concat!("touchstone ", env!("CARGO_PKG_VERSION")).to_owned())
        .set_compression(Compression::SNAPPY)
        // Samples hardly repeat, so a dictionary is wasted. Splitting doubles into byte planes puts slowly changing signs and
        // exponents side by side, which Snappy then packs.
        .set_dictionary_enabled(false)
        .set_encoding(Encoding::BYTE_STREAM_SPLIT)
        .set_key_value_metadata(Some(
            metadata
                .map(|(key, value)| KeyValue::new(key.to_owned(), value))
                .collect(),
        ))
}

/// Values of one column of a table other than a trace.
#[derive(Debug, Clone)]
pub enum Values<'a> {
    /// Numbers; a missing value is NaN.
    Numbers(Vec<f64>),
    /// Texts, one per row.
    Words(Vec<&'a str>),
}

/// The bytes of a Parquet file with named columns of equal length and with metadata.
///
/// # Errors
/// The columns cannot be encoded, for example because their lengths differ.
pub fn table(columns: &[(&str, Values<'_>)], metadata: &[(&str, String)]) -> io::Result<Vec<u8>> {
    let write = || -> Result<Vec<u8>, ParquetError> {
        let fields = columns
            .iter()
            .map(|(name, values)| match values {
                Values::Numbers(_) => numbers(name),
                Values::Words(_) => required(
                    Type::primitive_type_builder(name, Physical::BYTE_ARRAY)
                        .with_logical_type(Some(LogicalType::String)),
                ),
            })
            .collect::<Result<Vec<_>, _>>()?;
        let mut properties = builder(metadata.iter().cloned());
        for (name, values) in columns {
            if let Values::Words(_) = values {
                let path = ColumnPath::from(*name);
                properties = properties
                    .set_column_encoding(path.clone(), Encoding::PLAIN)
                    .set_column_dictionary_enabled(path, true);
            }
        }
        let schema = Type::group_type_builder("table")
            .with_fields(fields)
            .build()?;
        let mut out = Vec::new();
        let mut file =
            SerializedFileWriter::new(&mut out, Arc::new(schema), Arc::new(properties.build()))?;
        let mut group = file.next_row_group()?;
        for (_, values) in columns {
            let mut writer = group.next_column()?.expect("as many columns as the schema");
            match values {
                Values::Numbers(values) => {
                    writer
                        .typed::<DoubleType>()
                        .write_batch(values, None, None)?;
                }
                Values::Words(words) => {
                    let words: Vec<ByteArray> = words.iter().map(|word| (*word).into()).collect();
                    writer
                        .typed::<ByteArrayType>()
                        .write_batch(&words, None, None)?;
                }
            }
            writer.close()?;
        }
        group.close()?;
        file.close()?;
        Ok(out)
    };
    write().map_err(io::Error::other)
}

fn required(builder: PrimitiveTypeBuilder<'_>) -> Result<Arc<Type>, ParquetError> {
    builder
        .with_repetition(Repetition::REQUIRED)
        .build()
        .map(Arc::new)
}

fn numbers(name: &str) -> Result<Arc<Type>, ParquetError> {
    required(Type::primitive_type_builder(name, Physical::DOUBLE))
}

#[cfg(test)]
mod tests {
    use std::fs::File;

    use ::parquet::column::reader::ColumnReader;
    use ::parquet::file::reader::{FileReader, SerializedFileReader};

    use super::*;
    use crate::synthetic;
    use touchstone_control::LawKind;

    /// Writes a run's trace and reads it back: trace, metadata, and number of row groups.
    fn round_trip(run: &Run, name: &str) -> (Trace, Vec<(String, String)>, usize) {
        let path =
            std::env::temp_dir().join(format!("touchstone-{}-{name}.parquet", std::process::id()));
        write(
            File::create(&path).unwrap(),
            run,
            run.trace.as_ref().unwrap(),
            1,
            &[("command", "touchstone".to_owned())],
        )
        .unwrap();
        let file = SerializedFileReader::new(File::open(&path).unwrap()).unwrap();
        std::fs::remove_file(&path).unwrap();
        let meta = file.metadata().file_metadata();
        let names: Vec<&str> = meta
            .schema_descr()
            .columns()
            .iter()
            .map(|c| c.name())
            .collect();
        assert_eq!(names, COLUMNS.iter().map(|c| c.name).collect::<Vec<_>>());
        let pairs = meta.key_value_metadata().unwrap().iter();
        let pairs = pairs
            .map(|pair| (pair.key.clone(), pair.value.clone().unwrap()))
            .collect();
        let mut read = vec![Vec::new(); COLUMNS.len()];
        for group in 0..file.num_row_groups() {
            let group = file.get_row_group(group).unwrap();
            for (index, column) in read.iter_mut().enumerate() {
                let ColumnReader::DoubleColumnReader(mut reader) =
                    group.get_column_reader(index).unwrap()
                else {
                    panic!("not a column of doubles");
                };
                reader.read_records(usize::MAX, None, None, column).unwrap();
            }
        }
        (columns::from_columns(read), pairs, file.num_row_groups())
    }

    fn assert_same(a: &Trace, b: &Trace) {
        for column in COLUMNS {
            let bits = |trace| {
                (column.values)(trace)
                    .iter()
                    .map(|v: &f64| v.to_bits())
                    .collect::<Vec<_>>()
            };
            assert_eq!(bits(a), bits(b), "{}", column.name);
        }
    }

    #[test]
    fn reads_back_to_the_bit_with_metadata() {
        let run = synthetic::run(LawKind::Tdpa, 2.5, 0.5);
        let (read, meta, groups) = round_trip(&run, "short");
        assert_same(run.trace.as_ref().unwrap(), &read);
        assert_eq!(groups, 1);
        let value = |key: &str| meta.iter().find(|pair| pair.0 == key).unwrap().1.clone();
        assert_eq!(value("law"), "tdpa");
        assert_eq!(value("command"), "touchstone");
        assert_eq!(value("scene"), run.summary.scene);
        let units: serde_json::Value = serde_json::from_str(&value("units")).unwrap();
        assert_eq!(units["force_n_m"], "N·m");
        let summary: serde_json::Value = serde_json::from_str(&value("summary")).unwrap();
        assert_eq!(summary["k_desired"], 2.5);
    }

    #[test]
    fn a_long_trace_has_several_groups_and_an_empty_one_none() {
        let mut run = synthetic::run(LawKind::Spring, 1.0, 0.01);
        let column = |c: usize| (0..GROUP + 5).map(|i| (i * (c + 1)) as f64 * 0.1).collect();
        run.trace = Some(columns::from_columns(
            (0..COLUMNS.len()).map(column).collect(),
        ));
        let (read, _, groups) = round_trip(&run, "long");
        assert_same(run.trace.as_ref().unwrap(), &read);
        assert_eq!(groups, 2);
        run.trace = Some(Trace::default());
        let (read, _, groups) = round_trip(&run, "empty");
        assert_eq!((columns::len(&read), groups), (0, 0));
    }

    #[test]
    fn a_full_disk_keeps_its_kind() {
        struct Full;
        impl Write for Full {
            fn write(&mut self, _: &[u8]) -> io::Result<usize> {
                Err(io::ErrorKind::StorageFull.into())
            }
            fn flush(&mut self) -> io::Result<()> {
                Ok(())
            }
        }
        let run = synthetic::run(LawKind::Spring, 1.0, 0.01);
        let error = write(Full, &run, run.trace.as_ref().unwrap(), 1, &[]).unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::StorageFull);
    }
}
