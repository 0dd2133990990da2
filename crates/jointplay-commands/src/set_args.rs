//! Values of parameters of files, as given on the command line.

use clap::Args;

use crate::failure::Failure;
use crate::finite::finite;

/// `NAME=NUMBER`, in the unit of the file.
#[derive(Clone, Debug)]
pub(crate) struct Assignment {
    pub(crate) name: String,
    pub(crate) value: f64,
}

pub(crate) fn assignment(text: &str) -> Result<Assignment, String> {
    let (name, value) = text
        .rsplit_once('=')
        .ok_or_else(|| format!("invalid value {text:?}: expected NAME=VALUE"))?;
    Ok(Assignment { name: name.trim().to_owned(), value: finite(value)? })
}

/// Values of parameters of the file.
#[derive(Args, Clone)]
pub(crate) struct SetArgs {
    /// Values of parameters of the file, in its units
    #[arg(long, value_name = "PARAMETER=VALUE", value_delimiter = ',', value_parser = assignment)]
    pub(crate) set: Vec<Assignment>,
}

impl SetArgs {
    /// Refuses values of parameters with this text.
    pub(crate) fn refuse(&self, text: &str) -> Result<(), Failure> {
        if self.set.is_empty() { Ok(()) } else { Err(Failure::Usage(text.to_owned())) }
    }

    /// Values of parameters in place of those of the file, in its units.
    pub(crate) fn replaced(&self) -> Vec<(String, f64)> {
        self.set.iter().map(|one| (one.name.clone(), one.value)).collect()
    }
}
