// SPDX-License-Identifier: Apache-2.0
import AVFoundation
import OdographPhone
import SwiftUI

let pipeline = """
odograph: 1
walker: {height: 1.70 m}
attitude: {plugin: attitude/vqf}
step_estimator: {plugin: step/odograph}
vo_frontend: {plugin: vo/odograph}
surface_finder: {plugin: surface/planes}
coupling: {type: localizer}
"""

/// Tracks and shows the camera's picture and the phone's position while visible. A tap leaves a mark.
public struct TrackerView: View {
    @State private var tracker: OdographTracker?
    @State private var text = "move the phone"
    private let clock = Timer.publish(every: 0.1, on: .main, in: .common).autoconnect()

    public init() {}

    public var body: some View {
        ZStack(alignment: .bottom) {
            if let tracker { CameraView(tracker: tracker).ignoresSafeArea() }
            Text(text).font(.title2).monospacedDigit().padding().background(.thinMaterial)
        }
            .task { await begin() }
            .onReceive(clock) { _ in show() }
            .onDisappear { tracker?.stop(); tracker = nil }
    }

    private func begin() async {
        guard await AVCaptureDevice.requestAccess(for: .video) else {
            text = "Odograph needs the camera."
            return
        }
        do {
            let made = try OdographTracker(config: pipeline)
            try made.start()
            tracker = made
        } catch {
            text = error.localizedDescription
        }
    }

    private func show() {
        var pose = OdographPose()
        guard let tracker, tracker.getPose(&pose) else { return }
        let unit = pose.metric ? "m" : "(scale unknown)"
        text = String(format: "%@\nnorth %.2f, east %.2f, up %.2f %@\nwalked %.1f m",
                      tracker.text(ofState: pose.state), pose.north, pose.east, -pose.down, unit, pose.distance)
    }
}
