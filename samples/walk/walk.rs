// SPDX-License-Identifier: Apache-2.0
//! A recording read, and a walk tracked live, in Rust.
//!
//!     walk CONFIG.yaml RECORDING.odo
use odograph::{abi::*, Event, Options, Recording, Result, Session};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::Arc;

const CONFIG: &str = "odograph: 1
walker: {height: 1.70 m}
attitude: {plugin: attitude/vqf}
step_estimator: {plugin: step/odograph}
coupling: {type: localizer}
navigation: {start: {position: [0 m, 0 m, 0 m], heading: 0 deg}}
";

fn show(event: Event<'_>) {
    if let Some(Pose { header, p_n: [x, y, z], q_n: [qw, qx, qy, qz], .. }) = event.get() {
        println!("pose {} {x} {y} {z} {qx} {qy} {qz} {qw}", header.t_ns);
    }
    // Landmarks, the most certain first.
    if let Some(first) = event.points().next() {
        println!("points {} first {} {}", event.points().count(), first.id, first.p_c[2] as f64);
    }
}

/// Offset of the pixels of a grey picture. PGM needs no library; an app decodes JPEG and PNG with its own library.
fn decode(picture: &[u8], frame: &mut Frame) -> usize {
    let head = String::from_utf8_lossy(&picture[..24]).into_owned();
    let words: Vec<&str> = head.split_whitespace().take(4).collect();
    frame.format = ODO_FORMAT_GREY8;
    frame.width = words[1].parse().expect("a width");
    frame.height = words[2].parse().expect("a height");
    words.iter().map(|word| word.len() + 1).sum()
}

/// Puts an anchor on what lies ahead, 45 degrees down: usually the floor.
fn place(session: &Session) -> Result<()> {
    let ray = Ray { kind: ODO_RAY_VIEW, t_ns: ODO_TIME_LATEST, direction: [0.0, 1.0, 1.0], ..Ray::default() };
    for hit in session.hit_test(&ray, 1)? {
        let on = AnchorPlace { kind: ODO_ANCHOR_HIT, t_ns: hit.t_ns, q: hit.q_n, p: hit.p_n, surface: hit.surface, sigma_m: hit.sigma_m, ..AnchorPlace::default() };
        let anchor = session.create_anchor(&on, "on the floor")?;
        println!("hit {} {} {} anchor {anchor}", hit.what, hit.surface, hit.distance_m);
    }
    Ok(())
}

fn replay(config: &str, file: &str) -> Result<()> {
    let mut session = Session::new(&Options { config, ..Options::default() })?;
    session.on_event(&[Pose::TYPE, Points::TYPE], show)?;
    let mut recording = Recording::open(file)?;
    while let Some(recorded) = recording.next() {
        // A rejected sample is no reason to stop.
        if let (Some(mut frame), Some(picture)) = (recorded.message.get::<Frame>(), recorded.picture) {
            let (begin, width) = (decode(picture, &mut frame), frame.width as usize);
            session.push_frame(&frame, &Arc::new(picture.to_vec()), begin, width).ok();
        } else if recorded.message.is_input() {
            session.push_event(recorded.message).ok();
        }
    }
    session.flush()?;
    place(&session)
}

fn live() -> Result<()> {
    let steps = Arc::new(AtomicU32::new(0));
    let counted = steps.clone();
    let mut session = Session::new(&Options { config: CONFIG, live: true, ..Options::default() })?;
    session.on_event(&[Step::TYPE], move |_| { counted.fetch_add(1, Ordering::Relaxed); })?;
    let picture = Arc::new(vec![90u8; 64 * 48]); // as from a camera
    for i in 0..1000 {
        let (t, t_ns) = (i as f64 * 0.01, 1_000_000_000 + i * 10_000_000);
        session.push_imu(t_ns, [0.0, 0.01, 0.0], [0.1, 9.81 + 2.2 * (12.0 * t).sin(), 0.4])?;
        if i % 10 == 0 {
            let frame = Frame { format: ODO_FORMAT_GREY8, width: 64, height: 48, ..Frame::at(t_ns) };
            session.push_frame(&frame, &picture, 0, 64)?; // shared, not copied
            session.flush()?; // needed only because the simulated time does not wait
        }
    }
    let [north, east, down] = session.pose(ODO_TIME_LATEST).expect("a pose").p_n;
    let place = AnchorPlace { kind: ODO_ANCHOR_VIEW, t_ns: ODO_TIME_LATEST, p: [0.0, 0.0, -3.0], ..AnchorPlace::default() };
    let label = session.create_anchor(&place, "a label")?;
    let [x, y, z] = session.anchor(label, ODO_WORLD_CORRECTED, ODO_TIME_LATEST)?.p_n;
    let (steps, borrowed) = (steps.load(Ordering::Relaxed), Arc::strong_count(&picture) - 1);
    println!("live {steps} steps {north} {east} {down} label {x:.2} {y:.2} {z:.2} borrowed {borrowed}");
    Ok(())
}

fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().collect();
    match &arguments[..] {
        [_, config, recording] => replay(config, recording).and_then(|()| live()),
        _ => panic!("usage: walk CONFIG.yaml RECORDING.odo"),
    }
}
