// SPDX-License-Identifier: Apache-2.0
//
// Templates of `odograph plugin new --language rust`; words between @ are replaced.
#pragma once

namespace odograph {

/// The parts that depend on the kind: the same small algorithms as in C++ and C.
struct RustSkeleton {
  const char* kind;
  const char* input;  // the message that it processes
  const char* state;  // members
  const char* body;   // body of on(message, output)
};

inline const RustSkeleton kRustSkeletons[] = {
    {"attitude", "Imu", "    heading_rad: f64,\n    up_b: [f64; 3],\n    last_ns: i64,\n",
     R"(        // Beyond any sensor's range; it would corrupt up_b permanently.
        if ![message.gyro_b, message.accel_b].iter().flatten().all(|x| x.abs() < 1e3) {
            return Err(ODO_E_DISCARD);
        }
        let t_ns = message.header.t_ns;
        let dt = if self.state.last_ns == 0 { 0.0 } else { 1e-9 * (t_ns.wrapping_sub(self.state.last_ns)) as f64 };
        self.state.last_ns = t_ns;
        let blend = if dt > 0.0 { (self.gain * dt).min(1.0) } else { 1.0 };
        let up = &mut self.state.up_b;
        for (up, accel) in up.iter_mut().zip(message.accel_b) {
            *up += (accel - *up) * blend;
        }
        let norm = up.iter().map(|x| x * x).sum::<f64>().sqrt();
        if norm.is_nan() || norm <= 1.0 {
            return Ok(());
        }
        let yaw_rate: f64 = -message.gyro_b.iter().zip(&*up).map(|(gyro, up)| gyro * up / norm).sum::<f64>(); // about down
        self.state.heading_rad += if dt > 0.0 && dt < 1.0 { yaw_rate * dt } else { 0.0 };
        // The shortest rotation from up_b to z, half a turn about x (up is -z in North-East-Down), the heading about z.
        let (mut w, mut x, mut y) = (norm + up[2], up[1], -up[0]);
        let q = (w * w + x * x + y * y).sqrt();
        let (s, c) = (self.state.heading_rad / 2.0).sin_cos();
        if q > 1e-6 * norm {
            w /= q;
            x /= q;
            y /= q;
        } else {
            (w, x, y) = (0.0, 1.0, 0.0);
        }
        let mut event = Attitude { q_n_b: [-c * x - s * y, c * w, s * w, c * y - s * x], ..Attitude::at(t_ns) };
        for i in 0..3 {
            event.covariance_n[4 * i] = 0.01;
        }
        output.emit(event)
)"},
    {"step_estimator", "Imu", "    last_ns: i64,\n    high: bool,\n    count: u32,\n",
     R"(        let (t_ns, before_ns) = (message.header.t_ns, self.state.last_ns);
        let high = message.accel_b.iter().map(|a| a * a).sum::<f64>().sqrt() > 10.8;
        let was_high = std::mem::replace(&mut self.state.high, high);
        let begins = high && !was_high;
        let lasted_ns = t_ns.wrapping_sub(before_ns);
        if !begins || lasted_ns < 300_000_000 {
            return Ok(());
        }
        self.state.last_ns = t_ns;
        if lasted_ns > 1_500_000_000 {
            return Ok(()); // the first of a walk
        }
        let index = self.state.count;
        self.state.count += 1;
        output.emit(Step {
            t_start_ns: before_ns,
            t_end_ns: t_ns,
            length_m: self.gain,
            sigma_m: 0.2 * self.gain,
            frequency_hz: 1e9 / lasted_ns as f64,
            index,
            ..Step::at(t_ns)
        })
)"},
    {"vo_frontend", "Frame", "    last_ns: Option<i64>,\n",
     R"(        let t_ns = message.header.t_ns;
        if self.state.last_ns.map_or(false, |last_ns| t_ns <= last_ns) {
            return Err(ODO_E_DISCARD);
        }
        match self.state.last_ns.replace(t_ns) {
            None => Ok(()),
            Some(t_from_ns) => output.emit(VoMotion {
                t_from_ns,
                camera: message.header.source,
                state: ODO_LOST,
                reason: ODO_REASON_INITIALISING,
                ..VoMotion::at(t_ns)
            }),
        }
)"},
    {"scale_source", "VoMotion", "",
     R"(        let units = message.p_c0_c1.iter().map(|p| p * p).sum::<f64>().sqrt();
        if message.header.flags & ODO_VO_TRANSLATION == 0 || !(units > 1e-9 && units < 1e9) {
            return Ok(());
        }
        let t_ns = message.header.t_ns;
        let scale = self.gain * 1e-9 * t_ns.wrapping_sub(message.t_from_ns) as f64 / units;
        output.emit(Scale {
            scale,
            sigma: 0.2 * scale,
            valid_from_ns: message.t_from_ns,
            valid_to_ns: t_ns,
            scale_group: message.scale_group,
            ..Scale::at(t_ns)
        })
)"},
    {"absolute_fixer", "Waypoint", "",
     R"(        if !(message.p_n[0].abs() < 1e7 && message.p_n[1].abs() < 1e7 && message.sigma_m < 1e7) {
            return Err(ODO_E_DISCARD); // not a position on the Earth
        }
        let sigma = message.sigma_m.max(self.gain * 0.01);
        let mut event = Fix { p_n: [message.p_n[0], message.p_n[1], 0.0], ..Fix::at(message.header.t_ns) };
        event.header.flags = ODO_FIX_NORTH | ODO_FIX_EAST | ODO_FIX_COVARIANCE;
        for i in 0..3 {
            event.covariance_n[4 * i] = sigma * sigma;
        }
        output.emit(event)
)"},
};

inline constexpr char kRust[] = R"(// SPDX-License-Identifier: Apache-2.0
//! @SUMMARY@.
use odograph::plugin::{Output, Parameter, Plugin};
use odograph::{abi::*, Event};

/// State that a reset sets to zero.
#[derive(Clone, Default)]
struct State {
@STATE@}

#[derive(Clone)]
struct Mine {
    gain: f64,
    #[allow(dead_code)]
    state: State,
}

impl Default for Mine {
    fn default() -> Self {
        Mine { gain: @DEFAULT@ as f64, state: State::default() }
    }
}

impl Plugin for Mine {
    const ID: &'static str = "@ID@";
    const VERSION: &'static str = "0.1.0";
    const SUMMARY: &'static str = "@SUMMARY@";
    const KIND: &'static str = @INTERFACE@;
    const PARAMETERS: &'static [Parameter] =
        &[Parameter { name: "gain", unit: "@UNIT@", min: @LOW@ as f64, max: @HIGH@ as f64, default: "@DEFAULT@", help: "@HELP@" }];

    fn set(&mut self, name: &str, value: f64) {
        if name == "gain" {
            self.gain = value;
        }
    }

    fn on(&mut self, message: Event<'_>, output: &Output) -> Result<(), i32> {
        let message: @MESSAGE@ = match message.get() {
            Some(message) => message,
            None => return Ok(()),
        };
@BODY@    }
}

odograph::plugin!(Mine);
)";

inline constexpr char kCargo[] = R"([package]
name = "@FILE@"
version = "0.1.0"
edition = "2021"

[lib]
crate-type = ["cdylib"]

[profile.release]
strip = true  # before `odograph plugin manifest`, whose hash is of the file that ships

[dependencies]
odograph = { path = "odograph", default-features = false }
)";

inline constexpr char kRustReadme[] = R"(# @ID@

```sh
ln -s PREFIX/share/odograph/bindings/rust odograph   # PREFIX: where Odograph is installed
cargo build --release && mkdir -p build && cp target/release/lib@FILE@.so build/@FILE@.so
odograph plugin manifest build/@FILE@.so
odograph plugin check build/@FILE@.so
odograph plugins @ID@ --plugins build   # its summary and its parameters, as it was built
odograph run -c pipeline.yaml -i RECORDING
```
)";

}  // namespace odograph
