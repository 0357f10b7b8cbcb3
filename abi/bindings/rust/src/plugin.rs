// SPDX-License-Identifier: Apache-2.0
//! Plugins in Rust: implement [`Plugin`] for a type and export it with `odograph::plugin!(Type);`. Build a `cdylib` that depends on
//! this crate with `default-features = false`; it then does not link to the Odograph library.
use crate::abi::*;
use crate::{sized, string, Event};
use std::mem::size_of;
use std::panic::{catch_unwind, AssertUnwindSafe};
use std::ptr::null;
use std::sync::atomic::{AtomicPtr, Ordering};

/// A numeric parameter, with its range and default in `unit`.
pub struct Parameter {
    pub name: &'static str,
    pub unit: &'static str,
    pub min: f64,
    pub max: f64,
    /// In YAML syntax.
    pub default: &'static str,
    pub help: &'static str,
}

/// A plugin. The instance is cloned before its first message, and a reset restores this clone. Calls may come from different
/// threads, but never overlap.
pub trait Plugin: Clone + Default + Send + 'static {
    /// group/name, used in configs
    const ID: &'static str;
    /// major.minor.patch
    const VERSION: &'static str;
    /// One sentence.
    const SUMMARY: &'static str;
    /// ODO_INTERFACE_*
    const KIND: &'static str;
    const PARAMETERS: &'static [Parameter] = &[];

    /// Sets a parameter to a value of the config, which is within its range.
    fn set(&mut self, _name: &str, _value: f64) {}

    /// Processes an input message. `Err` is an ODO_E_* status: ODO_E_DISCARD for an unusable message.
    fn on(&mut self, message: Event<'_>, output: &Output) -> Result<(), i32>;
}

/// Emits events and reports within a call of the plugin.
pub struct Output {
    host: *const odo_host,
    number: u32,
    sink: *const odo_sink,
}

impl Output {
    /// Emits an event. `Err` is the status from the host; an event that is newer than the host is no error.
    pub fn emit<M: Message>(&self, event: M) -> Result<(), i32> {
        self.emit_message(&sized(&event) as *const M as *const odo_header)
    }

    /// Emits a surface with its outline: x and y of each vertex in m, counterclockwise. Those beyond ODO_MOST_VERTICES are left out.
    pub fn emit_surface(&self, surface: Surface, outline: &[[f32; 2]]) -> Result<(), i32> {
        #[repr(C)]
        struct Outlined {
            surface: Surface,
            outline: [Vertex; ODO_MOST_VERTICES as usize],
        }
        let mut event = Outlined { surface: sized(&surface), outline: [Vertex::default(); ODO_MOST_VERTICES as usize] };
        let count = outline.len().min(event.outline.len());
        for (vertex, p) in event.outline.iter_mut().zip(outline) {
            vertex.p = *p;
        }
        event.surface.count = count as u32;
        event.surface.stride = size_of::<Vertex>() as u32;
        event.surface.offset = size_of::<Surface>() as u32;
        event.surface.header.struct_size = (size_of::<Surface>() + count * size_of::<Vertex>()) as u32;
        self.emit_message(&event as *const Outlined as *const odo_header)
    }

    fn emit_message(&self, event: *const odo_header) -> Result<(), i32> {
        let emit = unsafe { self.sink.as_ref() }.and_then(|sink| sink.emit).ok_or(ODO_E_STATE)?;
        match unsafe { emit(self.sink, event) } {
            status if status < 0 && status != ODO_E_UNSUPPORTED => Err(status),
            _ => Ok(()),
        }
    }

    /// Reports a text to the user. The host publishes at most one report per second for each `key`.
    pub fn report(&self, severity: u32, key: &str, text: &str) {
        let id = ODO_SERVICE_REPORT;
        let get = unsafe { self.host.as_ref() }.and_then(|host| host.get_service);
        let service = get.map_or(null(), |get| unsafe { get(self.host, id.as_ptr() as *const _, id.len() as u64) }) as *const odo_report_service;
        if let Some(report) = unsafe { service.as_ref() }.and_then(|service| service.report) {
            unsafe { report(self.host, self.number, severity, &string(key), &string(text)) }
        }
    }
}

struct Instance<P> {
    output: Output,
    plugin: P,
    fresh: P,
}

/// Runs a call; a panic becomes a status and a report.
unsafe fn guarded<P>(instance: *mut odo_instance, work: impl FnOnce(&mut Instance<P>) -> i32) -> i32 {
    let instance = match (instance as *mut Instance<P>).as_mut() {
        Some(instance) => instance,
        None => return ODO_E_ARGUMENT,
    };
    catch_unwind(AssertUnwindSafe(|| work(instance))).unwrap_or_else(|panic| {
        let text = panic.downcast_ref::<String>().cloned().or_else(|| panic.downcast_ref::<&str>().map(|text| text.to_string()));
        instance.output.report(ODO_SEVERITY_ERROR, "panic", &text.unwrap_or_else(|| "a panic".into()));
        ODO_E_ERROR
    })
}

unsafe extern "C" fn create<P: Plugin>(host: *const odo_host, number: u32, kind: *const odo_string, out: *mut *mut odo_instance) -> i32 {
    let wanted = kind.as_ref().map(|kind| std::slice::from_raw_parts(kind.data as *const u8, kind.size as usize));
    if out.is_null() || wanted != Some(P::KIND.as_bytes()) {
        return ODO_E_UNSUPPORTED;
    }
    let made = catch_unwind(|| Box::new(Instance { output: Output { host, number, sink: null() }, plugin: P::default(), fresh: P::default() }));
    made.map_or(ODO_E_ERROR, |made| {
        *out = Box::into_raw(made) as *mut odo_instance;
        ODO_OK
    })
}

unsafe extern "C" fn configure<P: Plugin>(instance: *mut odo_instance, values: *const odo_value, count: u32, stride: u32) -> i32 {
    guarded::<P>(instance, |me| {
        for i in 0..count as usize {
            let value = &*((values as *const u8).add(i * stride as usize) as *const odo_value); // the rows of a newer host may be larger
            let name = std::slice::from_raw_parts(value.name.data as *const u8, value.name.size as usize);
            if let (Ok(name), false) = (std::str::from_utf8(name), value.reals.is_null()) {
                me.plugin.set(name, *value.reals);
            }
        }
        me.fresh = me.plugin.clone();
        ODO_OK
    })
}

unsafe extern "C" fn activate<P: Plugin>(instance: *mut odo_instance, sink: *const odo_sink) -> i32 {
    guarded::<P>(instance, |me| {
        me.output.sink = sink;
        ODO_OK
    })
}

unsafe extern "C" fn process<P: Plugin>(instance: *mut odo_instance, batch: *const odo_batch) -> i32 {
    let mut worst = ODO_OK;
    for i in 0..(*batch).count as usize {
        let message = Event(&**(*batch).messages.add(i));
        let status = guarded::<P>(instance, |me| me.plugin.on(message, &me.output).err().unwrap_or(ODO_OK));
        worst = worst.min(status);
    }
    worst
}

unsafe extern "C" fn reset<P: Plugin>(instance: *mut odo_instance) -> i32 {
    guarded::<P>(instance, |me| {
        me.plugin = me.fresh.clone();
        ODO_OK
    })
}

unsafe extern "C" fn destroy<P: Plugin>(instance: *mut odo_instance) {
    if !instance.is_null() {
        catch_unwind(AssertUnwindSafe(|| drop(Box::from_raw(instance as *mut Instance<P>)))).ok();
    }
}

/// The table of a plugin and its strings, created once and never freed.
pub struct Table(AtomicPtr<(odo_string, Vec<odo_parameter>)>);

impl Table {
    #[allow(clippy::new_without_default)]
    pub const fn new() -> Table {
        Table(AtomicPtr::new(std::ptr::null_mut()))
    }

    fn texts<P: Plugin>(&self) -> &'static (odo_string, Vec<odo_parameter>) {
        if self.0.load(Ordering::Acquire).is_null() {
            let rows = P::PARAMETERS.iter().map(|p| odo_parameter {
                struct_size: size_of::<odo_parameter>() as u32,
                kind: ODO_PARAMETER_REAL,
                name: string(p.name),
                unit: string(p.unit),
                help: string(p.help),
                default_text: string(p.default),
                min: p.min,
                max: p.max,
                count: 1,
                ..odo_parameter::default()
            });
            let made = Box::into_raw(Box::new((string(P::KIND), rows.collect())));
            if self.0.compare_exchange(std::ptr::null_mut(), made, Ordering::AcqRel, Ordering::Acquire).is_err() {
                drop(unsafe { Box::from_raw(made) }); // another thread was faster
            }
        }
        unsafe { &*self.0.load(Ordering::Acquire) }
    }

    /// # Safety
    /// `host` and `out` must be the arguments of the entry function.
    pub unsafe fn fill<P: Plugin>(&self, host: *const odo_host, out: *mut odo_plugin) -> i32 {
        if host.is_null() || out.is_null() || (*out).struct_size < ODO_PLUGIN_SIZE_MIN {
            return ODO_E_STRUCT_SIZE;
        }
        if (*host).abi_major_min > ODO_ABI_MAJOR || (*host).abi_major_max < ODO_ABI_MAJOR {
            (*out).refusal = string("the plugin was built for another ABI than the host's");
            return ODO_E_VERSION;
        }
        let (kind, parameters) = self.texts::<P>();
        let room = (*out).struct_size.min(size_of::<odo_plugin>() as u32); // an older host has a smaller table
        let table = odo_plugin {
            struct_size: room,
            abi_major: ODO_ABI_MAJOR,
            abi_minor: ODO_ABI_MINOR,
            interface_count: 1,
            interfaces: kind,
            id: string(P::ID),
            version: string(P::VERSION),
            summary: string(P::SUMMARY),
            parameters: parameters.as_ptr(),
            parameter_count: parameters.len() as u32,
            parameter_stride: size_of::<odo_parameter>() as u32,
            create: Some(create::<P>),
            configure: Some(configure::<P>),
            activate: Some(activate::<P>),
            process: Some(process::<P>),
            reset: Some(reset::<P>),
            destroy: Some(destroy::<P>),
            ..odo_plugin::default()
        };
        std::ptr::copy_nonoverlapping(&table as *const odo_plugin as *const u8, out as *mut u8, room as usize);
        ODO_OK
    }
}

