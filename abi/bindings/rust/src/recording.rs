// SPDX-License-Identifier: Apache-2.0
//! Recordings (*.odo), read and written.
use crate::abi::*;
use crate::session::{check, check_abi, with_error, written};
use crate::{sized, string, Event, Result};
use std::os::raw::c_void;
use std::ptr::{null, null_mut, NonNull};

/// A recorded message, and for a frame the encoded picture.
pub struct Recorded<'a> {
    pub message: Event<'a>,
    pub picture: Option<&'a [u8]>,
}

/// A recording, which is read once: `while let Some(recorded) = recording.next() { ... }`
pub struct Recording(NonNull<odo_recording>);
unsafe impl Send for Recording {}

impl Recording {
    pub fn open(path: &str) -> Result<Recording> {
        check_abi()?;
        let mut made = null_mut();
        with_error(|error| unsafe { odo_recording_open(&string(path), &mut made, error) })?;
        Ok(Recording(NonNull::new(made).expect("a recording was opened")))
    }

    /// Returns the next message in time order, borrowed until the next call (which is why this is no `Iterator`). Records that
    /// cannot be read are skipped and counted in `loss`.
    #[allow(clippy::should_implement_trait)]
    pub fn next(&mut self) -> Option<Recorded<'_>> {
        let (mut message, mut picture, mut size) = (null(), null(), 0);
        let mut status = ODO_E_DATA;
        while status == ODO_E_DATA {
            status = unsafe { odo_recording_next(self.0.as_ptr(), &mut message, &mut picture, &mut size) };
        }
        if status != ODO_OK {
            return None;
        }
        let picture = (!picture.is_null()).then(|| unsafe { std::slice::from_raw_parts(picture as *const u8, size as usize) });
        Some(Recorded { message: Event(unsafe { &*message }), picture })
    }

    /// Describes missing data; None if the recording is complete.
    pub fn loss(&self) -> Option<String> {
        written(|loss| unsafe { odo_recording_loss(self.0.as_ptr(), loss) }).map(|error| error.message)
    }
}
impl Drop for Recording {
    fn drop(&mut self) {
        unsafe { odo_recording_close(self.0.as_ptr()) }
    }
}

/// Writes a recording; `close` fails if not all data reached the file.
pub struct Recorder(NonNull<odo_recorder>);
unsafe impl Send for Recorder {}

impl Recorder {
    pub fn create(path: &str) -> Result<Recorder> {
        check_abi()?;
        let mut made = null_mut();
        with_error(|error| unsafe { odo_recorder_create(&string(path), &mut made, error) })?;
        Ok(Recorder(NonNull::new(made).expect("a recorder was made")))
    }

    /// Appends a message, and for a frame the encoded picture (PNG or JPEG).
    pub fn write<M: Message>(&mut self, message: &M, picture: &[u8]) -> Result<()> {
        let message = sized(message);
        let header = &message as *const M as *const odo_header;
        check(unsafe { odo_recorder_write(self.0.as_ptr(), header, picture.as_ptr() as *const c_void, picture.len() as u64) }).map(|_| ())
    }

    pub fn close(self) -> Result<()> {
        let recorder = self.0.as_ptr();
        std::mem::forget(self);
        check(unsafe { odo_recorder_close(recorder) }).map(|_| ())
    }
}
impl Drop for Recorder {
    fn drop(&mut self) {
        unsafe { odo_recorder_close(self.0.as_ptr()) };
    }
}
