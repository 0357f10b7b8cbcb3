// SPDX-License-Identifier: Apache-2.0
//! Odograph: a metric 6-DoF pose of a hand-held phone from its camera and motion sensors.
//!
//! ```no_run
//! use odograph::{abi::*, Options, Session};
//! let mut session = Session::new(&Options { config: "walk.yaml", ..Options::default() })?;
//! session.on_event(&[Pose::TYPE], |event| if let Some(pose) = event.get::<Pose>() { println!("{:?}", pose.p_n) })?;
//! session.push(&Imu { gyro_b: [0.0; 3], accel_b: [0.0, 0.0, 9.81], ..Imu::at(0) })?;
//! # Ok::<(), odograph::Error>(())
//! ```
//!
//! Structs, fields and constants have their C names; the headers state units, frames of reference and validity.
pub mod abi;
pub mod plugin;
#[cfg(feature = "app")]
mod recording;
#[cfg(feature = "app")]
mod session;

use abi::*;
#[cfg(feature = "app")]
pub use recording::{Recorded, Recorder, Recording};
#[cfg(feature = "app")]
pub use session::{reason_text, state_text, version, Options, Session};
use std::mem::size_of;
use std::os::raw::c_char;

/// An error of the library.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Error {
    /// ODO_E_*
    pub status: i32,
    pub message: String,
}
impl std::fmt::Display for Error {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        out.write_str(&self.message)
    }
}
impl std::error::Error for Error {}
pub type Result<T> = std::result::Result<T, Error>;

pub(crate) fn string(text: &str) -> odo_string {
    odo_string { data: text.as_ptr() as *const c_char, size: text.len() as u64 }
}

/// Returns a copy with the correct size and type in its header: `header` is public, and the library reads struct_size bytes.
pub(crate) fn sized<M: Message>(message: &M) -> M {
    let mut made = *message;
    let header = unsafe { &mut *(&mut made as *mut M as *mut odo_header) };
    header.struct_size = size_of::<M>() as u32;
    header.kind = M::TYPE;
    made
}

/// Converts a terminated text of a message, for example `text` of a report.
pub fn text(characters: &[c_char]) -> String {
    let bytes: Vec<u8> = characters.iter().take_while(|c| **c != 0).map(|c| *c as u8).collect();
    String::from_utf8_lossy(&bytes).into_owned()
}

/// A borrowed message of any type.
#[derive(Clone, Copy)]
pub struct Event<'a>(pub(crate) &'a odo_header);
impl<'a> Event<'a> {
    pub fn header(&self) -> &'a odo_header {
        self.0
    }
    pub fn is_input(&self) -> bool {
        self.0.kind >> 12 != 1
    }
    /// The landmarks of a Points; none of another type.
    pub fn points(&self) -> impl Iterator<Item = Point> + 'a {
        let message: Points = self.get().unwrap_or_default();
        self.elements(message.count, message.stride, message.offset)
    }
    /// The outline of a Surface; none of another type.
    pub fn outline(&self) -> impl Iterator<Item = Vertex> + 'a {
        let message: Surface = self.get().unwrap_or_default();
        self.elements(message.count, message.stride, message.offset)
    }
    fn elements<E: Copy + 'a>(&self, count: u32, stride: u32, offset: u32) -> impl Iterator<Item = E> + 'a {
        let (base, end) = (self.0 as *const odo_header as *const u8, self.0.struct_size as u64);
        let (offset, stride) = (offset as u64, stride as u64);
        let count = if stride < size_of::<E>() as u64 { 0 } else { count as u64 };
        (0..count)
            .map(move |i| offset + i * stride)
            .take_while(move |at| at + stride <= end)
            .map(move |at| unsafe { std::ptr::read_unaligned(base.add(at as usize) as *const E) })
    }
    /// Returns a copy of the message if it has that type. Fields that the message lacks are zero. Landmarks are not copied: see points().
    pub fn get<M: Message>(&self) -> Option<M> {
        if self.0.kind != M::TYPE {
            return None;
        }
        let mut message = M::at(0);
        let size = size_of::<M>().min(self.0.struct_size as usize);
        unsafe {
            std::ptr::copy_nonoverlapping(self.0 as *const odo_header as *const u8, &mut message as *mut M as *mut u8, size);
            (*(&mut message as *mut M as *mut odo_header)).struct_size = size as u32;
        }
        Some(message)
    }
}

