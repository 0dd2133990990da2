//! A whole plan over all cores.

use std::ops::Range;

use rayon::prelude::*;

use super::block::{BLOCK, Block, CHUNK};
use super::compute::compute;
use super::definition::Plan;
use crate::Error;

/// Cores that one chunk keeps busy: it has sixteen blocks.
const CORES_OF_A_CHUNK: usize = 8;

/// Computes a plan from one of its chunks on, over the cores of the current thread pool, and passes the chunks on in order.
///
/// While some chunks are taken, the next are computed; no more than these are in memory.
///
/// # Arguments
/// * `from` – the first chunk, counted from 0
/// * `encode` – makes of the blocks of a chunk what is to be taken; called for several chunks at a time
/// * `take` – is called with the chunks in order, and returns whether to continue
///
/// # Errors
/// As [`compute`], and those of `encode` and `take`.
pub fn run<T: Send, E: From<Error> + Send>(
    plan: &Plan,
    from: u64,
    encode: impl Fn(&[Block]) -> Result<T, E> + Sync,
    mut take: impl FnMut(&[Block], T) -> Result<bool, E> + Send,
) -> Result<(), E> {
    let chunks = plan.samples()?.div_ceil(CHUNK);
    let wave = rayon::current_num_threads().div_ceil(CORES_OF_A_CHUNK) as u64;
    let mut here = from..(from + wave).min(chunks);
    let mut ready = computed(plan, here.clone())?;
    while !ready.is_empty() {
        let next = here.end..(here.end + wave).min(chunks);
        let (taken, computed) = rayon::join(
            || -> Result<bool, E> {
                let encoded: Vec<T> =
                    ready.par_iter().map(|blocks| encode(blocks)).collect::<Result<_, E>>()?;
                for (blocks, encoded) in ready.iter().zip(encoded) {
                    if !take(blocks, encoded)? {
                        return Ok(false);
                    }
                }
                Ok(true)
            },
            || computed(plan, next.clone()),
        );
        if !taken? {
            return Ok(());
        }
        (ready, here) = (computed?, next);
    }
    Ok(())
}

/// The blocks of some chunks.
fn computed(plan: &Plan, chunks: Range<u64>) -> Result<Vec<Vec<Block>>, Error> {
    let count = plan.samples()?;
    let block = |first: u64, end: u64| {
        let samples: Vec<u64> = (first..(first + BLOCK as u64).min(end)).collect();
        compute(plan, &samples)
    };
    chunks
        .into_par_iter()
        .map(|chunk| {
            let (first, end) = (chunk * CHUNK, ((chunk + 1) * CHUNK).min(count));
            let blocks = (end - first).div_ceil(BLOCK as u64);
            (0..blocks).into_par_iter().map(|k| block(first + k * BLOCK as u64, end)).collect()
        })
        .collect()
}
