//! Documents of requests and responses, in SI units that are part of the field names.

#![expect(clippy::approx_constant, reason = "attributes take literals only")]

pub(crate) mod cell;
pub(crate) mod cell_chain;
pub(crate) mod cell_entry;
pub(crate) mod cell_export;
pub(crate) mod cell_jog;
pub(crate) mod cell_jogged;
pub(crate) mod cell_parts;
pub(crate) mod cell_pose;
pub(crate) mod cell_samples;
mod command;
pub(crate) mod controller;
pub(crate) mod mechanism;
pub(crate) mod mechanism_view;
mod model;
pub(crate) mod pose;
pub(crate) mod program_parameters;
pub(crate) mod quantity;
pub(crate) mod question;
pub(crate) mod robot;
pub(crate) mod robot_file;
mod sampling_rate;
pub(crate) mod study;

pub(crate) use command::{CommandFields, HeightKind, Target, rods};
pub(crate) use model::{ModelChoice, VirtualizationName};

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::problem::Problem;

/// Two numbers: x and y.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(value_type = Vec<f64>, min_items = 2, max_items = 2)]
pub(crate) struct Pair(pub(crate) [f64; 2]);

/// Three numbers: x, y and z, or one for each limb.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(value_type = Vec<f64>, min_items = 3, max_items = 3)]
pub(crate) struct Triple(pub(crate) [f64; 3]);

/// Bytes of another format.
#[derive(ToSchema)]
#[schema(value_type = String, format = Binary)]
#[expect(dead_code, reason = "used by the OpenAPI description only")]
pub(crate) struct Binary(Vec<u8>);

/// q_1, q_2, q_3 (m).
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, ToSchema)]
#[schema(value_type = Vec<RodLength>, min_items = 3, max_items = 3)]
pub(crate) struct Rods(pub(crate) [f64; 3]);

/// A rod length (m).
#[derive(ToSchema)]
#[schema(minimum = -1000, maximum = 1000)]
#[expect(dead_code, reason = "used by the OpenAPI description only")]
struct RodLength(f64);

/// A tilt angle (rad).
#[derive(ToSchema)]
#[schema(exclusive_minimum = -1.5707963267948966, exclusive_maximum = 1.5707963267948966)]
#[expect(dead_code, reason = "used by the OpenAPI description only")]
pub(crate) struct TiltAngle(f64);

/// Largest magnitude of a length in a request (m).
pub(crate) const MAX_LENGTH: f64 = 1000.0;
/// Largest magnitude of an angle in a request, except for tilt angles (rad).
pub(crate) const MAX_ANGLE: f64 = 1000.0;
/// Exclusive upper limit of the magnitude of a tilt angle (rad).
pub(crate) const RIGHT_ANGLE: f64 = std::f64::consts::FRAC_PI_2;

/// Checks a length (m).
pub(crate) fn length(value: f64, field: &str) -> Result<f64, Problem> {
    if value.abs() <= MAX_LENGTH {
        return Ok(value);
    }
    let detail = format!("lengths must be within ±{MAX_LENGTH} m, got {value:e} m");
    Err(Problem::field(field, detail))
}

/// Checks an angle (rad).
pub(crate) fn angle(value: f64, field: &str) -> Result<f64, Problem> {
    if value.abs() <= MAX_ANGLE {
        return Ok(value);
    }
    let detail = format!("angles must be within ±{MAX_ANGLE} rad, got {value:e} rad");
    Err(Problem::field(field, detail))
}

/// Checks a tilt angle (rad).
pub(crate) fn tilt_angle(value: f64, field: &str) -> Result<f64, Problem> {
    if value.abs() < RIGHT_ANGLE {
        return Ok(value);
    }
    let detail = format!("the tilt angle must be between -π/2 and π/2, got {value} rad");
    Err(Problem::field(field, detail))
}
