//! `touchstone monitor`: prints a device's measurements and commands live, and writes every control period (tick) as CSV.

use super::device::warn_unwatched;
use super::number;
use super::out::{self, print_over, say, tell};
use super::port::PortOption;
use super::stream::{self, Until};
use super::whole::{Named, Overwrite};
use std::fs::File;
use std::io::IsTerminal;
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};
use touchstone_device::{Client, may_be_on};
use touchstone_link::counted::Counted;
use touchstone_link::told;
use touchstone_link::words::{name_of, page};
use touchstone_protocol::{Fault, FaultCode, Limit, Limits, Phase, Reply, Request, Telemetry};
use touchstone_report::csv::decimal;
use touchstone_sim::error::{Error, Result};
use touchstone_sim::output;

/// Time between two updates of the line on a terminal; without a terminal, one line per second is printed.
const LIVE: Duration = Duration::from_millis(100);
const LOGGED: Duration = Duration::from_secs(1);
/// Options of `touchstone monitor`.
#[derive(Debug, Clone, clap::Args)]
pub struct Options {
    #[command(flatten)]
    port: PortOption,
    /// Writes every received record to this CSV file.
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    #[command(flatten)]
    overwrite: Overwrite,
    /// Arms the board, which must be calibrated, and switches it off at the end.
    #[arg(long)]
    arm: bool,
    /// Ends after this many seconds; without this option, at Ctrl-C.
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = number::up_to(1e9, "of seconds"))]
    seconds: Option<f64>,
    /// Number of control periods per record.
    #[arg(long, value_name = "TICKS", default_value_t = 1, allow_negative_numbers = true, value_parser = number::within(1_u16, 1000, "of ticks"))]
    decimation: u16,
}

/// Runs `touchstone monitor`.
pub fn main(options: &Options) -> Result<()> {
    // Ctrl-C ends the loop, so that the CSV file is completed and the device returns to its earlier telemetry rate.
    let stop = super::interrupt::noted()?;
    let csv = options.csv.as_deref().map(|path| Named {
        path,
        option: "--csv",
        replaces: options.overwrite.force,
    });
    csv.map_or(Ok(()), |place| place.check())?;
    let mut client = options.port.connect()?;
    let settings = client.settings()?;
    warn_unwatched(&settings);
    let mut table = match csv {
        Some(place) => Some(Table::new(place, settings.timing.rate_hz)?),
        None => None,
    };
    let dropped_before = dropped(&mut client)?;
    let decimation = options.decimation;
    let mut last = None;
    let watched = stream::armed(&mut client, options.arm, |client| {
        client.tell(&Request::Telemetry { decimation })?;
        client.forget_telemetry();
        watch(client, options, &stop, &mut table, &mut last)
    });
    if options.arm {
        // The board has confirmed that it is off, or the error says that it may still be on.
        last = None;
    }
    if let Some(table) = &mut table {
        table.flush()?;
    }
    let unseen = |failure| left_on(failure, last);
    let counted = watched.map_err(unseen)?;
    // Restores the telemetry rate of the settings. If the device is disconnected, the error of the loop was returned above.
    let decimation = settings.telemetry.decimation;
    let restored = client.tell(&Request::Telemetry { decimation });
    restored.map_err(unseen)?;
    let dropped = dropped(&mut client).map_err(unseen)?;
    let dropped = dropped.wrapping_sub(dropped_before);
    let file = options.csv.as_ref().map(|path| path.display().to_string());
    out::result(
        || {
            serde_json::json!({
                "records": counted.records,
                "lost_records": counted.lost,
                "dropped_by_device_records": dropped,
                "damaged_frames": client.decode_errors(),
                "file": file,
            })
        },
        || {
            tell!("");
            tell!(
                "{} records, {} lost ({dropped} dropped by the device, {} damaged in transmission)",
                counted.records,
                counted.lost,
                client.decode_errors()
            );
            if let Some(file) = &file {
                tell!("{file}");
            }
            Ok(())
        },
    )
}

/// Adds to the error of an unreachable device that it may still be on, if it was on in its last record.
fn left_on(failure: Error, last: Option<Phase>) -> Error {
    match failure {
        Error::Device {
            place,
            problem,
            fix,
        } if last.is_some_and(|phase| told::switched_off(phase).is_some()) => {
            may_be_on(place, &problem, &fix)
        }
        other => other,
    }
}

/// Number of records that the device has dropped so far because its port was too slow.
fn dropped(client: &mut Client) -> Result<u32> {
    match client.ask(&Request::Counters)? {
        Reply::Counters(counters) => Ok(counters.telemetry_dropped),
        other => Err(client.odd(&other)),
    }
}

fn watch(
    client: &mut Client,
    options: &Options,
    stop: &AtomicBool,
    table: &mut Option<Table>,
    last: &mut Option<Phase>,
) -> Result<Counted> {
    let live = std::io::stdout().is_terminal();
    let every = if live { LIVE } else { LOGGED };
    let (mut counted, mut shown) = (Counted::default(), None::<Instant>);
    let mut state = None;
    tell!("{HEADING}");
    let silent = out::json() || out::quiet();
    let until = Until {
        stop,
        seconds: options.seconds,
        // With a CSV file, recording continues after the reader of standard output has closed the pipe.
        unread: table.is_some(),
    };
    stream::records(client, until, |_, record| {
        counted.take(record.tick, options.decimation);
        *last = Some(record.phase);
        if let Some(table) = table {
            table.take(record)?;
        }
        let now = (record.phase, record.fault);
        if silent {
            return Ok(true);
        }
        let changed = state.replace(now).is_some_and(|before| before != now);
        if changed || shown.is_none_or(|shown| shown.elapsed() >= every) {
            shown = Some(Instant::now());
            let line = line(record, counted.lost);
            // A line with a changed state stays on the screen; other lines are overwritten by the next line.
            match (live, changed) {
                (true, ends) => print_over(&line, ends)?,
                (false, _) => say!("{line}"),
            }
        }
        Ok(true)
    })?;
    Ok(counted)
}

const HEADING: &str = "      tick  state        depth mrad  force mN·m   energy mJ  current A  cycles    late      lost  limits, fault";

fn line(record: &Telemetry, lost: u64) -> String {
    let fault = match record.fault {
        0 => String::new(),
        code => name_of(&Fault {
            code,
            tick: record.tick,
            value: 0,
        }),
    };
    format!(
        "{:>10}  {:<11} {:>11.3} {:>11.2} {:>11.4} {:>10.3} {:>7} {:>7} {:>9}  {} {fault:<24}",
        record.tick,
        record.phase.name(),
        1e3 * record.penetration_rad.to_num::<f64>(),
        1e3 * record.force_n_m.to_num::<f64>(),
        1e3 * record.energy_j.0.to_num::<f64>(),
        f64::from(record.current_q_ma) / 1e3,
        record.cycles,
        record.lateness_cycles,
        lost,
        limits(record.limits),
    )
}

/// Names of the limits that reduced the device's force, from the bits of a telemetry record.
fn limits(bits: u8) -> String {
    let limits = Limits::from_wire(bits);
    let names: Vec<String> = Limit::ALL
        .into_iter()
        .filter(|limit| limits.has(*limit))
        .map(|limit| format!("{limit:?}").to_lowercase())
        .collect();
    names.join("+")
}

/// Columns of the CSV file. A quantity that also occurs in a simulated run's trace has the same column name there.
const COLUMNS: [&str; 13] = [
    "tick",
    "time_s",
    "count",
    "penetration_rad",
    "force_n_m",
    "offset_rad",
    "energy_observed_j",
    "state",
    "fault",
    "limits",
    "cycles",
    "lateness_cycles",
    "current_q_a",
];

/// Writes all telemetry records as CSV rows.
struct Table<'a> {
    file: csv::Writer<File>,
    place: Named<'a>,
    rate_hz: u32,
    first: Option<u32>,
    /// Number of CSV rows in the buffer that are not yet written to the file.
    waiting: u32,
}

/// Number of CSV rows that are written to the file at once, so that an interrupted program leaves no incomplete row.
const ROWS_AT_ONCE: u32 = 128;
/// Size of the row buffer in bytes: room for twice as many rows as are written at once.
const ROOM: usize = 1 << 16;

impl<'a> Table<'a> {
    fn new(place: Named<'a>, rate_hz: u32) -> Result<Self> {
        let file =
            output::begun(place.path, place.replaces).map_err(|error| place.error(&error))?;
        let file = csv::WriterBuilder::new()
            .buffer_capacity(ROOM)
            .from_writer(file);
        let mut table = Self {
            file,
            place,
            rate_hz,
            first: None,
            waiting: 0,
        };
        let begun = table.file.write_record(COLUMNS);
        begun.map_err(|error| place.error(&error.into()))?;
        if let Err(error) = table.flush() {
            // Removes the file, because it has no rows. A device or a pipe stays.
            if place.path.symlink_metadata().is_ok_and(|it| it.is_file()) {
                let _ = std::fs::remove_file(place.path);
            }
            return Err(error);
        }
        Ok(table)
    }

    /// Adds a record as one row, with all digits: the decimal text of a fixed-point number is exact.
    fn take(&mut self, record: &Telemetry) -> Result<()> {
        let first = *self.first.get_or_insert(record.tick);
        let time = f64::from(record.tick.wrapping_sub(first)) / f64::from(self.rate_hz);
        let fault = match FaultCode::from_wire(record.fault) {
            _ if record.fault == 0 => String::new(),
            Some(code) => page(code),
            None => record.fault.to_string(),
        };
        let written = self.file.write_record([
            record.tick.to_string(),
            decimal(time),
            record.count.to_string(),
            decimal(record.penetration_rad),
            decimal(record.force_n_m),
            decimal(record.offset_rad),
            decimal(record.energy_j),
            Phase::name(record.phase).to_owned(),
            fault,
            limits(record.limits),
            record.cycles.to_string(),
            record.lateness_cycles.to_string(),
            decimal(f64::from(record.current_q_ma) / 1e3),
        ]);
        written.map_err(|error| self.place.error(&error.into()))?;
        self.waiting += 1;
        match self.waiting < ROWS_AT_ONCE {
            true => Ok(()),
            false => self.flush(),
        }
    }

    fn flush(&mut self) -> Result<()> {
        self.waiting = 0;
        let flushed = self.file.flush();
        flushed.map_err(|error| self.place.error(&error))
    }
}

#[cfg(test)]
mod tests {
    use super::{COLUMNS, Named, Table, Telemetry};
    use touchstone_protocol::Decimal;

    /// Checks that other programs read each column as decimals, not as integers or text, even if 30,000 records of zeros come
    /// before the first record with a force.
    #[test]
    fn others_read_what_a_monitor_keeps() {
        use fixed::types::I8F24;
        let nothing = Telemetry {
            tick: 0,
            count: 0,
            penetration_rad: I8F24::ZERO,
            since_change_rad: I8F24::ZERO,
            force_n_m: I8F24::ZERO,
            offset_rad: I8F24::ZERO,
            energy_j: Decimal::lit("0"),
            phase: touchstone_protocol::Phase::Armed,
            fault: 0,
            limits: 0,
            cycles: 0,
            lateness_cycles: 0,
            current_q_ma: 0,
            measuring: None,
        };
        let file = std::env::temp_dir().join(format!("touchstone-told-{}.csv", std::process::id()));
        let place = Named {
            path: &file,
            option: "--csv",
            replaces: true,
        };
        // The control period at 3 kHz has no short decimal form.
        let mut table = Table::new(place, 3000).unwrap();
        for tick in 0..30_000 {
            table.take(&Telemetry { tick, ..nothing }).unwrap();
        }
        let pushed = Telemetry {
            tick: 30_000,
            penetration_rad: I8F24::from_bits(12_345),
            force_n_m: I8F24::from_bits(-1),
            offset_rad: I8F24::from_bits(7),
            energy_j: Decimal::lit("0.015625"),
            current_q_ma: -4,
            ..nothing
        };
        table.take(&pushed).unwrap();
        table.flush().unwrap();
        let text = std::fs::read(&file).unwrap();
        std::fs::remove_file(&file).unwrap();
        crate::whole::is_read_by_others("monitor.csv", &text);
    }

    #[test]
    fn what_a_trace_has_too_bears_its_name() {
        let trace: Vec<&str> = touchstone_report::columns::COLUMNS
            .iter()
            .map(|column| column.name)
            .collect();
        for shared in ["time_s", "force_n_m", "energy_observed_j"] {
            assert!(
                COLUMNS.contains(&shared) && trace.contains(&shared),
                "{shared}"
            );
        }
        // The remaining columns exist only for a device: a simulated run's trace has none of them under another name.
        let own = COLUMNS.into_iter().filter(|name| !trace.contains(name));
        assert_eq!(
            own.collect::<Vec<_>>(),
            [
                "tick",
                "count",
                "penetration_rad",
                "offset_rad",
                "state",
                "fault",
                "limits",
                "cycles",
                "lateness_cycles",
                "current_q_a"
            ]
        );
    }
}
