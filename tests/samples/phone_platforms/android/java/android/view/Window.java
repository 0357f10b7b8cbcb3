// SPDX-License-Identifier: Apache-2.0
package android.view;
public abstract class Window {
  public void addFlags(int flags) {}
}
