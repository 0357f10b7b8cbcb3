// SPDX-License-Identifier: Apache-2.0
//! A session: one pipeline, from samples to poses.
use crate::abi::*;
use crate::{sized, string, Error, Event, Result};
use std::ffi::CStr;
use std::mem::size_of;
use std::os::raw::{c_char, c_void};
use std::panic::{catch_unwind, AssertUnwindSafe};
use std::ptr::{null, null_mut, NonNull};
use std::sync::Arc;

unsafe fn owned(text: *const c_char) -> String {
    CStr::from_ptr(text).to_string_lossy().into_owned()
}

pub(crate) fn check(status: i32) -> Result<i32> {
    if status >= 0 {
        return Ok(status);
    }
    Err(Error { status, message: unsafe { owned(odo_status_text(status)) } })
}

/// The library that the loader found may have another major version than the one that was linked.
pub(crate) fn check_abi() -> Result<()> {
    let found = unsafe { odo_abi_version() };
    if found >> 16 == ODO_ABI_MAJOR {
        return Ok(());
    }
    let message = format!("the library has ABI {}.{}, this crate {ODO_ABI_MAJOR}.{ODO_ABI_MINOR}", found >> 16, found & 0xFFFF);
    Err(Error { status: ODO_E_VERSION, message })
}

/// Runs a call that fills an odo_error.
pub(crate) fn with_error(call: impl FnOnce(*mut odo_error) -> i32) -> Result<()> {
    let mut error = odo_error { struct_size: size_of::<odo_error>() as u32, ..odo_error::default() };
    let status = call(&mut error);
    if status < 0 && error.message[0] != 0 {
        return Err(Error { status, message: unsafe { owned(error.message.as_ptr()) } });
    }
    check(status).map(|_| ())
}

/// What a call wrote into an odo_error; none if its status is ODO_OK.
pub(crate) fn written(call: impl FnOnce(*mut odo_error) -> i32) -> Option<Error> {
    let mut error = odo_error { struct_size: size_of::<odo_error>() as u32, ..odo_error::default() };
    let status = match call(&mut error) {
        ODO_OK => error.status,
        failed => failed,
    };
    (status != ODO_OK).then(|| Error { status, message: unsafe { owned(error.message.as_ptr()) } })
}

/// Version of the library, "major.minor.patch".
pub fn version() -> String {
    unsafe { owned(odo_version()) }
}
pub fn state_text(state: u32) -> String {
    unsafe { owned(odo_state_text(state)) }
}
pub fn reason_text(reason: u32) -> String {
    unsafe { owned(odo_reason_text(reason)) }
}

/// Options of a session.
#[derive(Clone, Copy, Default)]
pub struct Options<'a> {
    /// A YAML file, or its text: it has a line break or ": " in it, as every YAML mapping has. A path with either is taken for one.
    pub config: &'a str,
    /// Processes samples on a thread of the session; otherwise within `push`.
    pub live: bool,
    pub plugin_path: &'a str,
    pub asset_path: &'a str,
    pub seed: u64,
}

type Listener = Box<dyn FnMut(Event<'_>) + Send>;

/// A session: one pipeline. Functions with `&self` may be called on any thread, those with `&mut self` on one at a time.
pub struct Session {
    session: NonNull<odo_session>,
    listener: Option<Box<Listener>>, // the library holds its address
}
// Functions tagged [any] in odograph.h take &self, those tagged [control] &mut self. The listener is Send; its calls never overlap.
unsafe impl Send for Session {}
unsafe impl Sync for Session {}

impl Session {
    pub fn new(options: &Options<'_>) -> Result<Session> {
        check_abi()?;
        let config = string(options.config);
        let (config_text, config_path) = if options.config.contains('\n') || options.config.contains(": ") { (config, string("")) } else { (string(""), config) };
        let c = SessionOptions {
            struct_size: size_of::<SessionOptions>() as u32,
            run: if options.live { ODO_RUN_LIVE } else { ODO_RUN_REPLAY },
            config_path,
            config_text,
            plugin_path: string(options.plugin_path),
            asset_path: string(options.asset_path),
            seed: options.seed,
            ..SessionOptions::default()
        };
        let mut session = null_mut();
        with_error(|error| unsafe { odo_session_create(&c, &mut session, error) })?;
        Ok(Session { session: NonNull::new(session).expect("a session was made"), listener: None })
    }

    fn c(&self) -> *mut odo_session {
        self.session.as_ptr()
    }

    /// Calls `listener` with each event of these types (`Pose::TYPE`), or with all events if none is given: within `push` and `flush`,
    /// or on the library's thread when live. A panic in it aborts the process, because it must not unwind through the library.
    pub fn on_event(&mut self, types: &[u32], listener: impl FnMut(Event<'_>) + Send + 'static) -> Result<()> {
        unsafe extern "C" fn call(user: *mut c_void, event: *const odo_header) {
            let listener = &mut *(user as *mut Listener);
            if catch_unwind(AssertUnwindSafe(|| listener(Event(&*event)))).is_err() {
                std::process::abort();
            }
        }
        let mut boxed: Box<Listener> = Box::new(Box::new(listener));
        let user = &mut *boxed as *mut Listener as *mut c_void;
        let (pointer, count) = if types.is_empty() { (null(), ODO_ALL_EVENTS) } else { (types.as_ptr(), types.len() as u32) };
        check(unsafe { odo_session_set_callback(self.c(), pointer, count, Some(call), user) })?;
        self.listener = Some(boxed);
        Ok(())
    }

    /// Pushes an input. `Err` has the status of a rejected sample, such as a late one, which a live app can ignore.
    pub fn push<M: Message>(&self, message: &M) -> Result<()> {
        assert!(M::TYPE & ODO_BORROWED == 0, "push_frame takes frames");
        let message = sized(message);
        check(unsafe { odo_session_push(self.c(), &message as *const M as *const odo_header) }).map(|_| ())
    }

    /// Pushes a recorded input unchanged. Not for frames, whose pictures are encoded.
    pub fn push_event(&self, message: Event<'_>) -> Result<()> {
        assert!(message.0.kind & ODO_BORROWED == 0, "push_frame takes frames");
        check(unsafe { odo_session_push(self.c(), message.0) }).map(|_| ())
    }

    pub fn push_imu(&self, t_ns: i64, gyro_b: [f64; 3], accel_b: [f64; 3]) -> Result<()> {
        check(unsafe { odo_session_push_imu(self.c(), t_ns, gyro_b.as_ptr(), accel_b.as_ptr()) }).map(|_| ())
    }

    /// Pushes a frame with one plane: the pixels start at byte `begin` of `pixels`, the rows are `row_stride` bytes apart. The library
    /// shares ownership of the pixels while it needs them, without copy or allocation.
    pub fn push_frame<P: AsRef<[u8]> + Send + Sync + 'static>(&self, frame: &Frame, pixels: &Arc<P>, begin: usize, row_stride: usize) -> Result<()> {
        unsafe extern "C" fn retain<P>(owner: *mut c_void) -> i32 {
            Arc::increment_strong_count(owner as *const P);
            ODO_OK
        }
        unsafe extern "C" fn release<P>(owner: *mut c_void) {
            Arc::decrement_strong_count(owner as *const P);
        }
        let pixel = match frame.format {
            ODO_FORMAT_GREY8 => 1,
            ODO_FORMAT_RGB8 => 3,
            ODO_FORMAT_RGBA8 | ODO_FORMAT_BGRA8 => 4,
            _ => return Err(Error { status: ODO_E_ARGUMENT, message: format!("format {}: expected one of one plane", frame.format) }),
        };
        let bytes = (**pixels).as_ref();
        let (rows, row) = ((frame.height as usize).saturating_sub(1), frame.width as usize * pixel);
        if row_stride < row || bytes.len() < begin + rows * row_stride + row {
            let message = format!("{} bytes from {begin} on of {} x {} pixels", bytes.len(), frame.width, frame.height);
            return Err(Error { status: ODO_E_ARGUMENT, message });
        }
        let mut lent = sized(frame);
        lent.plane_count = 1;
        lent.planes[0] = odo_plane { data: bytes[begin..].as_ptr(), row_stride: row_stride as i64, pixel_stride: pixel as u32, rows: 0 };
        lent.mask = odo_plane::default();
        lent.header.flags &= !ODO_FRAME_MASK;
        lent.loan = odo_loan { owner: Arc::as_ptr(pixels) as *mut c_void, retain: Some(retain::<P>), release: Some(release::<P>), ..odo_loan::default() };
        check(unsafe { odo_session_push(self.c(), &lent.header) }).map(|_| ())
    }

    /// Processes all pushed samples without waiting for slower sensors.
    pub fn flush(&mut self) -> Result<()> {
        check(unsafe { odo_session_flush(self.c()) }).map(|_| ())
    }

    fn asked(&self, of: u32, smooth: bool, t_ns: i64) -> Option<Pose> {
        let mut pose = Pose::at(0);
        let world = if smooth { ODO_WORLD_SMOOTH } else { ODO_WORLD_CORRECTED };
        let status = unsafe { odo_session_get_pose_of(self.c(), of, world, t_ns, &mut pose) };
        (status == ODO_OK).then_some(pose)
    }
    /// Returns the pose at a time (ODO_TIME_LATEST: at the newest sample), which may be in the near future; none if not available.
    pub fn pose(&self, t_ns: i64) -> Option<Pose> {
        self.asked(ODO_OF_PIPELINE, false, t_ns)
    }
    /// The pose without jumps, for rendering.
    pub fn smooth_pose(&self, t_ns: i64) -> Option<Pose> {
        self.asked(ODO_OF_PIPELINE, true, t_ns)
    }
    /// The pose of the body or the camera: `of` is ODO_OF_*.
    pub fn pose_of(&self, of: u32, smooth: bool, t_ns: i64) -> Option<Pose> {
        self.asked(of, smooth, t_ns)
    }

    pub fn statistics(&self) -> Result<Statistics> {
        let mut made = Statistics { struct_size: size_of::<Statistics>() as u32, ..Statistics::default() };
        check(unsafe { odo_session_get_statistics(self.c(), &mut made) })?;
        Ok(made)
    }

    /// The latest error or warning since the last call.
    pub fn last_error(&self) -> Option<Error> {
        written(|error| unsafe { odo_session_last_error(self.c(), error) })
    }

    /// Creates an anchor and returns its id. Sets name and size of `place`.
    pub fn create_anchor(&self, place: &AnchorPlace, name: &str) -> Result<u64> {
        let mut id = 0;
        let place = AnchorPlace { struct_size: size_of::<AnchorPlace>() as u32, name: string(name), ..*place };
        check(unsafe { odo_anchor_create(self.c(), &place, &mut id) })?;
        Ok(id)
    }
    pub fn anchor(&self, id: u64, world: u32, t_ns: i64) -> Result<Anchor> {
        let mut anchor = Anchor { struct_size: size_of::<Anchor>() as u32, ..Anchor::default() };
        check(unsafe { odo_anchor_get(self.c(), id, world, t_ns, &mut anchor) })?;
        Ok(anchor)
    }
    pub fn anchors(&self) -> Vec<u64> {
        let mut ids = vec![0; unsafe { odo_anchor_list(self.c(), null_mut(), 0) }.max(0) as usize];
        let count = unsafe { odo_anchor_list(self.c(), ids.as_mut_ptr(), ids.len() as u64) };
        ids.truncate(count.max(0) as usize);
        ids
    }
    /// What a ray hits, nearest first, at most `most`. Sets the size of `ray`. Empty while position or scale are unknown.
    pub fn hit_test(&self, ray: &Ray, most: usize) -> Result<Vec<Hit>> {
        let ray = Ray { struct_size: size_of::<Ray>() as u32, ..*ray };
        let mut hits = vec![Hit { struct_size: size_of::<Hit>() as u32, ..Hit::default() }; most];
        let mut count = 0;
        check(unsafe { odo_session_hit_test(self.c(), &ray, hits.as_mut_ptr(), most as u32, &mut count) })?;
        hits.truncate(count as usize);
        Ok(hits)
    }
    pub fn remove_anchor(&self, id: u64) -> Result<()> {
        check(unsafe { odo_anchor_remove(self.c(), id) }).map(|_| ())
    }

    /// Anchors and parameters estimated by plugins, for `load` in a later session.
    pub fn save(&mut self) -> Result<Vec<u8>> {
        let mut data = vec![0u8; unsafe { odo_session_save(self.c(), null_mut(), 0) }.max(0) as usize];
        let size = unsafe { odo_session_save(self.c(), data.as_mut_ptr() as *mut c_void, data.len() as u64) };
        if size != data.len() as i64 {
            return Err(Error { status: ODO_E_ERROR, message: "the state could not be saved".into() });
        }
        Ok(data)
    }
    /// Maps of the places that this session has seen, with its anchors, for `load_map` in a later one.
    pub fn save_map(&mut self) -> Result<Vec<u8>> {
        let mut data = Vec::new();
        loop {
            let size = unsafe { odo_map_save(self.c(), data.as_mut_ptr() as *mut c_void, data.len() as u64) };
            if size == data.len() as i64 {
                return Ok(data);
            }
            check(size.min(0) as i32)?;
            data = vec![0u8; size as usize];
        }
    }
    /// An error if the map is damaged, or of plugins that the session does not have.
    pub fn load_map(&mut self, data: &[u8]) -> Result<()> {
        check(unsafe { odo_map_load(self.c(), data.as_ptr() as *const c_void, data.len() as u64) }).map(|_| ())
    }
    /// False if a plugin rejected its part, which `last_error` names; the others are restored.
    pub fn load(&mut self, data: &[u8]) -> Result<bool> {
        check(unsafe { odo_session_load(self.c(), data.as_ptr() as *const c_void, data.len() as u64) }).map(|status| status == ODO_OK)
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        unsafe { odo_session_destroy(self.c()) }
    }
}
