//! A whole study over all cores.

use rayon::prelude::*;

use super::block::Block;
use super::study::Study;
use crate::Error;

/// Cores that one chunk keeps busy: it has sixteen blocks.
const CORES_OF_A_CHUNK: usize = 8;

/// Computes a study from one of its chunks on, over the cores of the current thread pool, and passes the chunks on in order.
///
/// While some chunks are taken, the next are computed; no more than these are in memory.
///
/// # Arguments
/// * `from` – the first chunk, counted from 0
/// * `encode` – makes of the blocks of a chunk what is to be taken; called for several chunks at a time
/// * `take` – is called with the chunks in order, and returns whether to continue
///
/// # Errors
/// As [`Study::compute`], and those of `encode` and `take`.
pub fn run<T: Send, E: From<Error> + Send>(
    study: &dyn Study,
    from: u64,
    encode: impl Fn(&[Block]) -> Result<T, E> + Sync,
    mut take: impl FnMut(&[Block], T) -> Result<bool, E> + Send,
) -> Result<(), E> {
    let chunks = from..study.chunks()?;
    run_chunks(
        study,
        chunks,
        |_, blocks| encode(blocks),
        |_, blocks, encoded| take(blocks, encoded),
    )
}

/// Computes some chunks of a study, as [`run`] computes all.
///
/// # Arguments
/// * `chunks` – their numbers, counted from 0
/// * `encode`, `take` – as of [`run`], with the number of the chunk
///
/// # Errors
/// [`Error::NoSuchChunk`], and as [`run`].
pub fn run_chunks<T: Send, E: From<Error> + Send>(
    study: &dyn Study,
    mut chunks: impl Iterator<Item = u64> + Send,
    encode: impl Fn(u64, &[Block]) -> Result<T, E> + Sync,
    mut take: impl FnMut(u64, &[Block], T) -> Result<bool, E> + Send,
) -> Result<(), E> {
    let wave = rayon::current_num_threads().div_ceil(CORES_OF_A_CHUNK);
    let mut next = || computed(study, chunks.by_ref().take(wave).collect());
    let mut ready = next()?;
    while !ready.is_empty() {
        let (taken, computed) = rayon::join(
            || -> Result<bool, E> {
                let encoded: Vec<T> = ready
                    .par_iter()
                    .map(|(chunk, blocks)| encode(*chunk, blocks))
                    .collect::<Result<_, E>>()?;
                for ((chunk, blocks), encoded) in ready.iter().zip(encoded) {
                    if !take(*chunk, blocks, encoded)? {
                        return Ok(false);
                    }
                }
                Ok(true)
            },
            &mut next,
        );
        if !taken? {
            return Ok(());
        }
        ready = computed?;
    }
    Ok(())
}

/// The blocks of a chunk, in order, over the cores of the current thread pool.
///
/// # Arguments
/// * `chunk` – its number, counted from 0
///
/// # Errors
/// [`Error::NoSuchChunk`], and as [`Study::compute`].
pub fn compute_chunk(study: &dyn Study, chunk: u64) -> Result<Vec<Block>, Error> {
    let (samples, count) = (study.samples()?, study.chunks()?);
    if chunk >= count {
        return Err(Error::NoSuchChunk { found: chunk, count });
    }
    let portions = study.portions();
    let first = chunk * portions.chunk;
    let end = samples.min(first + portions.chunk);
    let size = portions.block as u64;
    let block = |k: u64| {
        let first = first + k * size;
        let samples: Vec<u64> = (first..(first + size).min(end)).collect();
        study.compute(&samples)
    };
    (0..(end - first).div_ceil(size)).into_par_iter().map(block).collect()
}

/// Some chunks with their blocks.
fn computed(study: &dyn Study, chunks: Vec<u64>) -> Result<Vec<(u64, Vec<Block>)>, Error> {
    chunks.into_par_iter().map(|chunk| Ok((chunk, compute_chunk(study, chunk)?))).collect()
}
