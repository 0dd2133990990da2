//! Studies, computed and streamed in batches.

use std::collections::HashMap;
use std::sync::Arc;
use std::time::{Duration, Instant};

use arrow_array::{ArrayRef, Float64Array, RecordBatch, UInt8Array};
use arrow_ipc::writer::StreamWriter;
use arrow_schema::{ArrowError, DataType, Field, Schema};
use axum::body::{Body, Bytes};
use jointplay::bulk::{Column, Quantity, Status};
use jointplay::format::robot::Robot;
use jointplay::report::table;
use jointplay::virtualization::{SolveOptions, Virtualization};
use tokio::sync::mpsc::{self, Sender};
use tokio_stream::wrappers::ReceiverStream;

use crate::problem::Problem;
use crate::state::AppState;
use crate::wire::study::{ColumnName, Commanded, Samples, Source, StudyRequest, columns};

/// Number of samples per batch: large enough to amortize the overhead of a message, small enough to show progress.
pub(crate) const BATCH: usize = 4096;
/// Longest time for which a client may leave a batch unread.
const MAX_PAUSE: Duration = Duration::from_secs(60);
/// Maximum number of samples of a file that is complete before it is sent, as in `jointplay simulate`.
#[cfg(feature = "parquet")]
const MAX_SAMPLES_IN_FILE: usize = 500_000;
/// Number of batches computed ahead of the client.
const QUEUED_BATCHES: usize = 4;

/// A checked study.
pub(crate) struct Study {
    robot: Arc<Robot>,
    samples: Samples,
    model: &'static (dyn Virtualization + Sync),
    options: SolveOptions,
    /// ρ of the metric (m).
    pub(crate) characteristic_length: f64,
    pub(crate) columns: Vec<ColumnName>,
}

/// A batch of samples of a study.
pub(crate) struct Batch {
    /// Values by column, NaN for samples without a solution.
    values: Vec<Vec<f64>>,
    status: Vec<Status>,
}

impl Study {
    /// Checks a request.
    pub(crate) fn new(robot: Arc<Robot>, request: StudyRequest) -> Result<Self, Problem> {
        let StudyRequest { motion, model: choice, quantities, .. } = request;
        let (model, options) = (choice.model(), choice.options("model")?);
        let samples = motion.read(&robot.gpr, "motion")?;
        let characteristic_length = options.metric.characteristic_length(robot.gpr.platform())?;
        let columns = columns(&samples, model, quantities.as_deref());
        Ok(Self { robot, samples, model, options, characteristic_length, columns })
    }

    /// Number of samples.
    pub(crate) fn len(&self) -> usize {
        self.samples.len()
    }

    /// Computes all batches, until the end or until `take` returns an error.
    fn run(&self, mut take: impl FnMut(&Batch) -> Result<(), Stopped>) -> Result<(), Stopped> {
        let mut commanded = self.samples.commanded();
        loop {
            let poses: Vec<Commanded> = commanded.by_ref().take(BATCH).collect();
            if poses.is_empty() {
                return Ok(());
            }
            take(&self.batch(&poses).map_err(Stopped::Core)?)?;
        }
    }

    fn batch(&self, poses: &[Commanded]) -> Result<Batch, jointplay::Error> {
        let gpr = &self.robot.gpr;
        let column = |value: fn(&Commanded) -> f64| poses.iter().map(value).collect::<Vec<f64>>();
        let (azimuth, tilt_angle) =
            (column(|pose| pose.tilt.azimuth), column(|pose| pose.tilt.angle));
        let height = column(|pose| pose.height.0);
        let mut status = vec![Status::Solved; poses.len()];
        let mut rods = [(); 3].map(|()| vec![f64::NAN; poses.len()]);
        let [azimuths, tilt_angles, heights] =
            [&azimuth, &tilt_angle, &height].map(|column| Column::from(&**column));
        gpr.inverse_many(
            azimuths,
            tilt_angles,
            heights,
            &mut status,
            rods.each_mut().map(|rod| &mut **rod),
        )?;
        let wanted = self.columns.iter().filter_map(|column| match column.source {
            Source::Model(quantity) => Some((quantity, vec![f64::NAN; poses.len()])),
            _ => None,
        });
        let mut results: Vec<(Quantity, Vec<f64>)> = wanted.collect();
        let mut slices: Vec<(Quantity, &mut [f64])> =
            results.iter_mut().map(|(quantity, column)| (*quantity, &mut **column)).collect();
        let given = rods.each_ref().map(|rod| Column::from(&**rod));
        gpr.forward_many(given, self.model, &self.options, &mut status, &mut slices)?;
        let mut results = results.into_iter().map(|(_, column)| column);
        let values = self.columns.iter().map(|column| match column.source {
            Source::Time => poses.iter().map(|pose| pose.time).collect(),
            Source::Azimuth => azimuth.clone(),
            Source::TiltAngle => tilt_angle.clone(),
            Source::Height => height.clone(),
            Source::Rod(k) => rods[k].clone(),
            Source::Model(_) => results.next().expect("there is a column for each quantity wanted"),
        });
        Ok(Batch { values: values.collect(), status })
    }

    /// Names and types of the columns, with metadata on all samples.
    fn schema(&self) -> Arc<Schema> {
        let number = |column: &ColumnName| Field::new(&column.name, DataType::Float64, false);
        let mut fields: Vec<Field> = self.columns.iter().map(number).collect();
        fields.push(Field::new("status", DataType::UInt8, false));
        let statuses: Vec<&str> = Status::ALL.into_iter().map(Status::name).collect();
        let metadata = [
            ("samples", self.len().to_string()),
            ("virtualization", self.model.name().to_owned()),
            ("solver", self.options.solver.to_string()),
            ("characteristic_length_m", self.characteristic_length.to_string()),
            ("statuses", serde_json::json!(statuses).to_string()),
        ];
        let metadata = HashMap::from(metadata.map(|(key, value)| (key.to_owned(), value)));
        Arc::new(Schema::new_with_metadata(fields, metadata))
    }
}

/// Why a study ended early.
enum Stopped {
    /// The client has disconnected or reads too slowly.
    Unread,
    /// The server is shutting down.
    Ended,
    /// The deadline has passed.
    TooLong(Duration),
    /// An error that concerns all samples.
    Core(jointplay::Error),
    /// The writer failed.
    Arrow(ArrowError),
}

impl Stopped {
    /// The error that ends the response, which has already started.
    fn into_io_error(self) -> std::io::Error {
        std::io::Error::other(match self {
            Self::Unread => "the client did not read the study".to_owned(),
            Self::Ended => "the server is shutting down".to_owned(),
            Self::TooLong(longest) => {
                format!("the study took longer than {} s", longest.as_secs_f64())
            }
            Self::Core(error) => error.to_string(),
            Self::Arrow(error) => error.to_string(),
        })
    }
}

/// Encoder of batches.
trait Format: Send + 'static {
    /// The bytes before all batches.
    fn start(&mut self) -> Result<Vec<u8>, Stopped>;
    /// The bytes of a batch.
    fn batch(&mut self, study: &Study, batch: &Batch) -> Result<Vec<u8>, Stopped>;
    /// The bytes after all batches.
    fn end(&mut self) -> Result<Vec<u8>, Stopped>;
}

/// An Arrow stream.
struct Arrow {
    schema: Arc<Schema>,
    writer: StreamWriter<Vec<u8>>,
}

impl Format for Arrow {
    fn start(&mut self) -> Result<Vec<u8>, Stopped> {
        Ok(std::mem::take(self.writer.get_mut()))
    }

    fn batch(&mut self, _: &Study, batch: &Batch) -> Result<Vec<u8>, Stopped> {
        let number = |values: &Vec<f64>| Arc::new(Float64Array::from(values.clone())) as ArrayRef;
        let mut arrays: Vec<ArrayRef> = batch.values.iter().map(number).collect();
        let status = batch.status.iter().map(|&status| status as u8);
        arrays.push(Arc::new(UInt8Array::from_iter_values(status)));
        let written = RecordBatch::try_new(Arc::clone(&self.schema), arrays)
            .and_then(|batch| self.writer.write(&batch));
        written.map_err(Stopped::Arrow)?;
        self.start()
    }

    fn end(&mut self) -> Result<Vec<u8>, Stopped> {
        self.writer.finish().map_err(Stopped::Arrow)?;
        self.start()
    }
}

/// Comma-separated values.
struct Csv {
    begun: bool,
}

impl Format for Csv {
    fn start(&mut self) -> Result<Vec<u8>, Stopped> {
        Ok(Vec::new())
    }

    fn batch(&mut self, study: &Study, batch: &Batch) -> Result<Vec<u8>, Stopped> {
        let text = table::csv(&batch.table(study));
        let heading = text.find('\n').map_or(0, |end| end + 1);
        let from = if self.begun { heading } else { 0 };
        self.begun = true;
        Ok(text.as_bytes()[from..].to_vec())
    }

    fn end(&mut self) -> Result<Vec<u8>, Stopped> {
        Ok(Vec::new())
    }
}

impl Batch {
    /// The batch as a table.
    fn table(&self, study: &Study) -> Vec<table::Column> {
        let named = study.columns.iter().zip(&self.values);
        let mut columns: Vec<table::Column> = named
            .map(|(column, values)| table::Column {
                name: column.name.clone(),
                values: table::Values::Real(values.clone()),
            })
            .collect();
        columns.push(table::Column {
            name: "status".to_owned(),
            values: table::Values::Count(self.status.iter().map(|&s| u32::from(s as u8)).collect()),
        });
        columns
    }
}

/// The study as an Arrow stream.
pub(crate) fn arrow(state: &AppState, study: Study) -> Result<Body, Problem> {
    let schema = study.schema();
    let writer = StreamWriter::try_new(Vec::new(), &schema)
        .map_err(|error| Problem::broken(&error.to_string()))?;
    stream(state, study, Arrow { schema, writer })
}

/// The study as comma-separated values.
pub(crate) fn csv(state: &AppState, study: Study) -> Result<Body, Problem> {
    stream(state, study, Csv { begun: false })
}

/// The study as a Parquet file.
#[cfg(feature = "parquet")]
pub(crate) async fn parquet(state: &AppState, study: Study) -> Result<Body, Problem> {
    let found = study.len();
    if found > MAX_SAMPLES_IN_FILE {
        let detail = format!(
            "the motion has {found} samples, at most {MAX_SAMPLES_IN_FILE} are allowed in a Parquet file: use larger steps or `study.csv`"
        );
        return Err(Problem::field("motion", detail));
    }
    let permit = state.work.study()?;
    let work = state.work.clone();
    let file = state.work.run(move || {
        let mut whole: Vec<table::Column> = Vec::new();
        let done = study.run(|batch| {
            if work.stopping() {
                return Err(Stopped::Ended);
            }
            let more = batch.table(&study);
            if whole.is_empty() {
                whole = more;
                return Ok(());
            }
            for (all, more) in whole.iter_mut().zip(more) {
                match (&mut all.values, more.values) {
                    (table::Values::Real(all), table::Values::Real(more)) => all.extend(more),
                    (table::Values::Count(all), table::Values::Count(more)) => all.extend(more),
                    _ => unreachable!("all batches have the same columns"),
                }
            }
            Ok(())
        });
        drop(permit);
        done.map_err(|stopped| Problem::broken(&stopped.into_io_error().to_string()))?;
        table::parquet(&whole).map_err(|error| Problem::broken(&error.to_string()))
    });
    Ok(Body::from(file.await?))
}

/// The problem of a build without Parquet.
#[cfg(not(feature = "parquet"))]
pub(crate) async fn parquet(_: &AppState, _: Study) -> Result<Body, Problem> {
    let detail =
        "this build has no Parquet support: build with --features parquet, or use `study.csv`";
    Err(Problem::unavailable(axum::http::StatusCode::NOT_IMPLEMENTED, detail))
}

/// Computes a study on a worker thread, at the rate at which the client reads.
fn stream(state: &AppState, study: Study, mut format: impl Format) -> Result<Body, Problem> {
    let permit = state.work.study()?;
    let work = state.work.clone();
    let (sender, receiver) = mpsc::channel::<Result<Bytes, std::io::Error>>(QUEUED_BATCHES);
    tokio::task::spawn_blocking(move || {
        let start = Instant::now();
        let send = |bytes: Vec<u8>| {
            if work.stopping() {
                return Err(Stopped::Ended);
            }
            let longest = work.deadlines.study;
            if start.elapsed() > longest {
                return Err(Stopped::TooLong(longest));
            }
            if bytes.is_empty() { Ok(()) } else { send_blocking(&sender, Ok(bytes.into())) }
        };
        let done = format
            .start()
            .and_then(send)
            .and_then(|()| study.run(|batch| send(format.batch(&study, batch)?)))
            .and_then(|()| send(format.end()?));
        if let Err(stopped) = done {
            // A disconnected client does not receive it.
            let _ = send_blocking(&sender, Err(stopped.into_io_error()));
        }
        drop(permit);
    });
    Ok(Body::from_stream(ReceiverStream::new(receiver)))
}

/// Sends a chunk once the queue has room for it.
fn send_blocking(
    sender: &Sender<Result<Bytes, std::io::Error>>,
    piece: Result<Bytes, std::io::Error>,
) -> Result<(), Stopped> {
    let sent = sender.send_timeout(piece, MAX_PAUSE);
    let sent = tokio::runtime::Handle::current().block_on(sent);
    sent.map_err(|_| Stopped::Unread)
}
