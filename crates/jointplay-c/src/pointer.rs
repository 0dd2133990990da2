//! Pointers of C: read, written, checked. They need not be aligned: packed structures and buffers of bytes are not.

use std::ffi::{CStr, c_char};

use crate::catch::Failure;

#[cold]
fn null(what: &str) -> Failure {
    Failure::input(format!("{what} is NULL"))
}

/// The object behind a handle.
///
/// # Safety
/// The handle is NULL, or came from this library and is not freed during `'a`.
#[inline]
pub(crate) unsafe fn object<'a, T>(handle: *const T, what: &str) -> Result<&'a T, Failure> {
    // SAFETY: the caller's promise; objects are never changed, so that shared references are sound.
    unsafe { handle.as_ref() }.ok_or_else(|| null(what))
}

/// N finite numbers.
///
/// # Safety
/// The pointer is NULL or points to N numbers.
#[inline]
pub(crate) unsafe fn numbers<const N: usize>(
    from: *const f64,
    what: &str,
) -> Result<[f64; N], Failure> {
    if from.is_null() {
        return Err(null(what));
    }
    // SAFETY: not NULL, and the caller promises N numbers.
    let found = unsafe { from.cast::<[f64; N]>().read_unaligned() };
    finite(&found, what)?;
    Ok(found)
}

/// A copy of `count` values; none where `count` is 0, whatever the pointer.
///
/// # Safety
/// The pointer is NULL or points to `count` values.
pub(crate) unsafe fn many<T: Copy>(
    from: *const T,
    count: usize,
    what: &str,
) -> Result<Vec<T>, Failure> {
    if count == 0 {
        return Ok(Vec::new());
    }
    if from.is_null() {
        return Err(null(what));
    }
    in_memory::<T>(count, what)?;
    // SAFETY: not NULL, and the caller promises `count` values.
    let value = |k: usize| unsafe { from.add(k).read_unaligned() };
    Ok((0..count).map(value).collect())
}

/// Refuses counts of values that no memory has.
pub(crate) fn in_memory<T>(count: usize, what: &str) -> Result<(), Failure> {
    match count.checked_mul(size_of::<T>()) {
        Some(bytes) if isize::try_from(bytes).is_ok() => Ok(()),
        _ => Err(Failure::input(format!("{what}: no memory has {count} of them"))),
    }
}

/// Refuses NaN and infinity.
#[inline]
pub(crate) fn finite(numbers: &[f64], what: &str) -> Result<(), Failure> {
    match numbers.iter().position(|number| !number.is_finite()) {
        None => Ok(()),
        Some(k) => Err(not_finite(what, k, numbers[k])),
    }
}

#[cold]
fn not_finite(what: &str, index: usize, number: f64) -> Failure {
    Failure::input(format!("{what}[{index}] is {number}, but has to be a finite number"))
}

/// Refuses NULL where a result is to be written, before anything is computed.
#[inline]
pub(crate) fn writable<T>(to: *mut T, what: &str) -> Result<(), Failure> {
    if to.is_null() { Err(null(what)) } else { Ok(()) }
}

/// Writes values one after another; nothing to NULL.
///
/// # Safety
/// The pointer is NULL or has room for all of them.
#[inline]
pub(crate) unsafe fn write<T: Copy>(to: *mut T, values: &[T]) {
    if !to.is_null() {
        // SAFETY: the caller's promise; the values are ours, and so do not overlap.
        unsafe {
            std::ptr::copy_nonoverlapping(
                values.as_ptr().cast::<u8>(),
                to.cast::<u8>(),
                size_of_val(values),
            );
        }
    }
}

/// A text.
///
/// # Safety
/// The pointer is NULL, or points to a text ended by NUL that does not change during `'a`.
pub(crate) unsafe fn text<'a>(from: *const c_char, what: &str) -> Result<&'a str, Failure> {
    if from.is_null() {
        return Err(null(what));
    }
    // SAFETY: not NULL, and the caller promises the NUL.
    let text = unsafe { CStr::from_ptr(from) };
    text.to_str().map_err(|error| Failure::input(format!("{what} is not UTF-8: {error}")))
}

/// Gives an object to the caller.
///
/// # Safety
/// The pointer has room for one handle.
pub(crate) unsafe fn give<T>(to: *mut *mut T, object: T) {
    let handle = Box::into_raw(Box::new(object));
    // SAFETY: the caller's promise.
    unsafe { to.write_unaligned(handle) };
}

/// Takes an object back; NULL does nothing.
///
/// # Safety
/// The handle is NULL, or came from [`give`] and is used nowhere any more.
pub(crate) unsafe fn take<T>(handle: *mut T) {
    if !handle.is_null() {
        // SAFETY: the caller's promise.
        drop(unsafe { Box::from_raw(handle) });
    }
}
