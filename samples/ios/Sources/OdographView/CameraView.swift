// SPDX-License-Identifier: Apache-2.0
import AVFoundation
import OdographPhone
import SwiftUI

/// The camera's picture. A tap puts a mark on the surface, landmark or floor that lies there.
struct CameraView: UIViewRepresentable {
    let tracker: OdographTracker

    func makeUIView(context: Context) -> MarkedPicture { MarkedPicture(tracker) }
    func updateUIView(_ view: MarkedPicture, context: Context) {}
}

final class MarkedPicture: UIView {
    private let tracker: OdographTracker
    private var marks: [(anchor: UInt64, target: String, label: UILabel)] = []
    private var frames: CADisplayLink?

    override class var layerClass: AnyClass { AVCaptureVideoPreviewLayer.self }
    private var preview: AVCaptureVideoPreviewLayer { layer as! AVCaptureVideoPreviewLayer }

    init(_ tracker: OdographTracker) {
        self.tracker = tracker
        super.init(frame: .zero)
        preview.session = tracker.captureSession
        preview.videoGravity = .resizeAspectFill
        addGestureRecognizer(UITapGestureRecognizer(target: self, action: #selector(tap)))
    }

    required init?(coder: NSCoder) { nil }

    override func didMoveToWindow() {
        frames?.invalidate()  // it retains this view
        frames = window == nil ? nil : CADisplayLink(target: self, selector: #selector(draw(at:)))
        frames?.add(to: .main, forMode: .common)
    }

    @objc private func tap(_ touch: UITapGestureRecognizer) {
        let point = preview.captureDevicePointConverted(fromLayerPoint: touch.location(in: self))
        // Too uncertain to draw on: move the phone first.
        guard let hit = tracker.raycast(from: point).first, hit.sigma < 0.1 * hit.distance else { return }
        let anchor = tracker.addAnchor(at: hit)
        guard anchor != 0 else { return }
        let label = UILabel()
        label.textColor = .white
        label.backgroundColor = .black
        addSubview(label)
        marks.append((anchor, hit.target, label))
    }

    @objc private func draw(at time: CADisplayLink) {
        for mark in marks {
            var point = CGPoint.zero, distance = 0.0
            mark.label.isHidden = !tracker.getAnchor(mark.anchor, point: &point, distance: &distance)
            mark.label.text = String(format: "%@ %.2f m", mark.target, distance)
            mark.label.sizeToFit()
            mark.label.center = preview.layerPointConverted(fromCaptureDevicePoint: point)
        }
    }
}
