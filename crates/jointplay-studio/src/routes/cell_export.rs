//! `/api/v1/cell/export`: the motion of a program as a file.

use axum::extract::State;
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};
use jointplay::cell::StopRequested;
use jointplay::cell::check::{CheckOptions, remedies};
use jointplay::format::display_units::DisplayUnits;
use jointplay::format::number::counted;
use jointplay::interop::export::dialect::{DIALECTS, Dialect, IncludedDialect};
use jointplay::interop::export::{self, MotionExport, SampleOptions, report_page};
use jointplay::report::{self, CellReport, PageProgram, table};

use super::lookup::{interrupted, no_motion};
use crate::body::Body;
use crate::plan::Plan;
use crate::problem::Problem;
use crate::state::AppState;
use crate::wire::Binary;
use crate::wire::cell_export::{CellExportFormat, CellExportRequest};
use crate::wire::program_parameters::with_parameters;

/// Maximum number of samples of a table or text, which is kept in memory until it is sent.
const MAX_SAMPLES: f64 = 500_000.0;
/// Maximum number of samples of a scene, which is made of all of them at once.
const MAX_SCENE_SAMPLES: f64 = 100_000.0;

/// The motion of a program as a file: samples, 3D scene, controller text, or report
///
/// The files are those of `jointplay cell export` and `jointplay cell report`; their name is in `content-disposition`.
#[utoipa::path(
    post,
    path = "/api/v1/cell/export",
    operation_id = "cell_export",
    request_body = CellExportRequest,
    responses(
        (status = 200, description = "The file", body = Binary, content_type = "application/octet-stream"),
        (status = 409, description = "There is no motion; or it has violations, and `despite_errors` is not set: `field` is then `despite_errors`", body = Problem, content_type = "application/problem+json"),
        (status = "4XX", description = "The request is invalid", body = Problem, content_type = "application/problem+json"),
        (status = "5XX", description = "The server cannot process the request", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn export(
    State(state): State<AppState>,
    Body(mut request): Body<CellExportRequest>,
) -> Result<Response, Problem> {
    let session = state.session()?;
    request.rate()?;
    if request.dialect.is_some() && request.format != CellExportFormat::Text {
        let detail = "only files of the format `text` have a dialect";
        return Err(Problem::field("dialect", detail.to_owned()));
    }
    let (cell, program) = session.texts(request.cell.take(), request.program.take());
    let program = with_parameters(program, std::mem::take(&mut request.parameters))?;
    let name = session.files().name();
    let permit = state.work.export()?;
    let made = move |stop: StopRequested<'_>| {
        let _permit = permit;
        let plan = session.plan(cell, program, stop).map_err(interrupted)?;
        file(&plan, name.as_deref(), &request, stop)
    };
    let File { name, contents } = state.work.run_while_awaited(made).await?;
    let disposition = format!("attachment; filename=\"{name}\"");
    let kind = "application/octet-stream";
    let headers = [(header::CONTENT_TYPE, kind), (header::CONTENT_DISPOSITION, &disposition)];
    Ok((headers, contents).into_response())
}

struct File {
    name: String,
    contents: Vec<u8>,
}

fn file(
    plan: &Plan,
    file: Option<&str>,
    request: &CellExportRequest,
    stop: StopRequested<'_>,
) -> Result<File, Problem> {
    let refused = |why: String| Problem::request(StatusCode::CONFLICT, why);
    let motion_export = plan.motion_export().ok_or_else(|| refused(no_motion(plan)))?;
    let violations = motion_export.violation_notes.len();
    let is_report = request.format == CellExportFormat::Report;
    if violations > 0 && !is_report && !request.despite_errors {
        let count = counted(violations, "violation");
        let detail =
            format!("{count}, not safe to run; set `despite_errors` to export the motion anyway");
        return Err(Problem::outdated("despite_errors", detail));
    }
    let rate = request.rate()?;
    let stem = file_stem(file);
    if is_report {
        let contents = page(plan, &motion_export, &format!("{stem}.program"), stop)?;
        return Ok(File { name: format!("{stem}-report.html"), contents: contents.into_bytes() });
    }
    let samples = |most: f64| {
        let found = motion_export.motion.duration() * rate;
        if found <= most {
            return Ok(());
        }
        let detail = format!(
            "the motion has {found:.0} samples at this rate, at most {most:.0} are allowed here: use a lower rate, or `jointplay cell export`, which writes files of any length"
        );
        Err(Problem::field("rate_hz", detail))
    };
    let mark = motion_export.name_warning();
    let failed = |error: export::Error| refused(error.to_string());
    let (ending, contents) = match request.format {
        CellExportFormat::Csv => {
            samples(MAX_SAMPLES)?;
            (".csv".to_owned(), csv(&motion_export, rate, stop)?)
        }
        CellExportFormat::Gltf => {
            samples(MAX_SCENE_SAMPLES)?;
            (".glb".to_owned(), export::gltf(&motion_export, rate).map_err(failed)?)
        }
        CellExportFormat::Text | CellExportFormat::Report => {
            let dialect = dialect(request.dialect.as_deref())?;
            if dialect.has_points() {
                samples(MAX_SAMPLES)?;
            }
            let contents = text(&dialect, &motion_export, rate, stop)?;
            (format!("-{}.{}", dialect.name, dialect.extension), contents)
        }
    };
    Ok(File { name: format!("{stem}{mark}{ending}"), contents })
}

/// The name of a cell file without its extension, with characters that are safe in a header.
fn file_stem(file: Option<&str>) -> String {
    let name = file.unwrap_or("example.toml");
    let stem = name.rsplit_once('.').map_or(name, |(stem, _)| stem);
    let safe = |c: char| if c.is_ascii_alphanumeric() || "-_. ".contains(c) { c } else { '_' };
    stem.chars().map(safe).collect()
}

fn csv(
    motion_export: &MotionExport<'_>,
    rate: f64,
    stop: StopRequested<'_>,
) -> Result<Vec<u8>, Problem> {
    let mut contents = Vec::new();
    let mut header = true;
    let options = SampleOptions::at_rate(rate);
    let written = export::samples_in_parts(motion_export, &options, |columns| {
        if stop() {
            return Err(Stopped::Interrupted);
        }
        table::write_csv(columns, std::mem::take(&mut header), &mut contents)
            .map_err(|error| Stopped::Failed(error.to_string()))
    });
    written.map(|()| contents).map_err(Problem::from)
}

fn text(
    dialect: &Dialect,
    motion_export: &MotionExport<'_>,
    rate: f64,
    stop: StopRequested<'_>,
) -> Result<Vec<u8>, Problem> {
    let mut contents = Vec::new();
    let written = dialect.write_in_parts(motion_export, rate, |part| {
        if stop() {
            return Err(Stopped::Interrupted);
        }
        contents.extend_from_slice(part.as_bytes());
        Ok(())
    });
    written.map(|()| contents).map_err(Problem::from)
}

/// Why a file was not completed.
enum Stopped {
    Interrupted,
    Failed(String),
}

impl From<Stopped> for Problem {
    fn from(stopped: Stopped) -> Self {
        match stopped {
            Stopped::Interrupted => interrupted(jointplay::cell::Interrupted),
            Stopped::Failed(why) => Self::request(StatusCode::CONFLICT, why),
        }
    }
}

impl From<export::Error> for Stopped {
    fn from(error: export::Error) -> Self {
        Self::Failed(error.to_string())
    }
}

fn dialect(name: Option<&str>) -> Result<Dialect, Problem> {
    let known = IncludedDialect::named(name.unwrap_or(DIALECTS[0].name));
    let known = known.map_err(|why| Problem::field("dialect", why))?;
    Dialect::parse(known.text).map_err(|errors| Problem::broken(&errors.to_string()))
}

/// The page of a report in mm and degrees, with remedies of violations.
fn page(
    plan: &Plan,
    motion_export: &MotionExport<'_>,
    name: &str,
    stop: StopRequested<'_>,
) -> Result<String, Problem> {
    let Some(check) = &plan.check else {
        return Err(Problem::request(StatusCode::CONFLICT, no_motion(plan)));
    };
    let MotionExport { cell, motion, program: text, .. } = *motion_export;
    let found = remedies(cell, motion, &CheckOptions::default(), check, stop);
    let remedies =
        Some(report::remedy_reports(cell, &found.map_err(interrupted)?, DisplayUnits::Metric));
    let document = report::cell(cell, text, motion, check, DisplayUnits::Metric);
    let report = &CellReport { remedies, ..document };
    report_page(motion_export, check, PageProgram { name, text, report }, None)
        .map_err(|error| Problem::request(StatusCode::CONFLICT, error.to_string()))
}
