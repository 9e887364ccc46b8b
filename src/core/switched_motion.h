#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>

#include <Eigen/Core>

#include "span_energy.h"
#include "vibro_impact/core/energy_account.h"
#include "vibro_impact/core/history.h"
#include "vibro_impact/core/impact.h"
#include "vibro_impact/core/switched_model.h"

namespace vibro_impact::core
{
/// The motion of a switched model, advanced exactly from one switch to the next.
///
/// Over an interval of the drive the base acceleration is  a(t) = a_0 + s t + Re D(t),  D' = i Omega D,  and in either
/// state
///
///   eta_n(t)  = f_n/omega_n^2 - Gamma_n/omega_n^2 (a_0 + s t - 2 zeta_n s/omega_n) + Re H_n D + Re z_n
///   z_n' = lambda_n z_n,    lambda_n = -zeta_n omega_n + i omega_n sqrt(1 - zeta_n^2),    H_n = -Gamma_n/(omega_n^2 -
///   Omega^2 + 2 i zeta_n omega_n Omega)
///
/// so that the gap is a straight line and a sum of exponentials,  g = p(t) + Re sum_n w_n z_n,  with the drive's phasor
/// D as one more exponential. A coordinate without stiffness, omega_n = 0, is instead
///
///   eta_n(t)  = eta_n(0) + eta_n'(0) t - Gamma_n (a_0 t^2/2 + s t^3/6) + Re H_n D,      H_n = Gamma_n/Omega^2
///
/// with eta_n' of the polynomial alone, and makes p a cubic if it moves the gap; that can only be one, and in S0. Time
/// inside an interval is counted in ticks, 2^-K of the interval and at most 1e-12 of the shortest period, and z is
/// advanced by factors exp(lambda tick 2^k) tabulated once: no transcendental function is evaluated between the
/// switches, nor at them.
///
/// A switch is found by steps that cannot skip one. If B bounds |g''|, a gap g > 0 with the rate g' cannot reach zero
/// before
///
///   s = (g' + sqrt(g'^2 + 2 g B))/B,        B = sum_n |w_n| |lambda_n|^2 |z_n|  (amplitudes only decay)
///
/// and near a root s converges on it as Newton's method does, from this side. The motion lands on a tick
/// just past the root, as soon as the gap can be told from zero (resolution_, its rounding error); the reported time
/// and speed are those of the root. Exactly zero gap with zero velocity is no switch: there the first derivative that
/// is not zero decides, and the motion is taken as far from the root as that derivative and a bound of the next one
/// allow.
class SwitchedMotion
{
public:
  /// No more switches are made in one interval than `switch_allowance` and one per half period of the highest
  /// frequency. Beyond these the motion stays in S1, where energy is neither made nor lost, to the end of the interval,
  /// and the interval is counted.
  static constexpr int switch_allowance = 256;

  /// Steps in one interval without a switch after which the smallest step, one tick, is doubled (and again after as
  /// many). A crossing that such a step overruns is still found by halving it; only a pair of crossings closer than the
  /// step is not.
  static constexpr int steps_before_coarser = 256;

  /// `phasor`: whether there is a harmonic drive D besides the linear one.
  SwitchedMotion(std::shared_ptr<const SwitchedModel> model, bool phasor);

  /// Sets the length of the intervals (s, > 0) and tabulates the factors. Allocates at the first call only.
  void setInterval(double length);

  /// Sets the harmonic drive, Re D = -amplitude cos(Omega t), t = 0 at the start of an interval, an interval being one
  /// drive cycle. Keeps displacement and velocity.
  void setHarmonicDrive(double frequency, double amplitude);

  /// Static equilibrium without base acceleration; impact numbers start anew.
  void rest();

  /// The same for a given motion, in the coordinates of S0.
  void start(const Eigen::VectorXd& displacement, const Eigen::VectorXd& velocity);

  /// Between two intervals, goes on where `previous` is, which moves a model of the same structures with another
  /// contact (the same coordinates in S0); `previous` is of no use afterwards. Displacements and velocities are kept,
  /// the gap changes by the change of the clearance, and its sign decides the state. An open episode goes on if the
  /// contact does; it is reported as cut short if not. Nothing is allocated.
  ///
  /// In the conjoined basis what must be mapped loses: where the stiffness is another one, all that is in S1 passes
  /// through S0. A change of clearance alone maps nothing, unless it switches the state.
  void takeOver(SwitchedMotion& previous, ImpactSink& sink);

  /// Advances over one interval in which the base acceleration goes from `from` to `to` in a straight line.
  void advanceLinear(double from, double to, ImpactSink& sink);

  /// Advances over one cycle of the harmonic drive.
  void advanceHarmonic(ImpactSink& sink);

  /// Reports an open episode as cut short, now.
  void interrupt(ImpactSink& sink);

  /// Now.
  HistorySample sample() const;

  /// From now on (until nullptr is given) every interval of the harmonic drive writes `per_interval` equally spaced
  /// samples, the last at its end. They are taken from copies, and the motion is the same bit for bit.
  void recordHistory(HistorySample* samples, std::size_t per_interval);

  double gap() const
  {
    return gap_;
  }
  /// The contact force now, N: -k g in S1. A gap within its rounding error of zero exerts no force.
  double force() const
  {
    return force(gap_);
  }
  bool inContact() const
  {
    return state_ == 1;
  }
  double gapRate() const
  {
    return rate_;
  }
  /// Displacement and velocity in the coordinates of the present state, at the start of the next interval.
  void coordinates(Eigen::VectorXd& displacement, Eigen::VectorXd& velocity) const;
  /// Sets displacement and velocity in the coordinates of S0, mapped where the gap says contact.
  void setFreeCoordinates(const Eigen::VectorXd& displacement, const Eigen::VectorXd& velocity);
  /// Kinetic and strain energy of both structures and the contact spring, J.
  double energy() const;

  std::uint64_t intervals() const
  {
    return intervals_;
  }
  /// Counts intervals from zero again; an open episode keeps its time.
  void restartIntervalCount();
  std::uint64_t switchLimitReached() const
  {
    return switch_limit_reached_;
  }
  /// Time spent in S1 since rest(), s.
  double contactTime() const
  {
    return contact_time_;
  }
  std::uint64_t switches() const
  {
    return switches_;
  }
  /// Evaluations of the gap on the way to switches, for those who measure.
  std::uint64_t steps() const
  {
    return steps_total_;
  }
  /// The same on the way to peak forces.
  std::uint64_t peakEvaluations() const
  {
    return peak_evaluations_;
  }
  double tick() const
  {
    return tick_;
  }
  const SwitchedModel& model() const
  {
    return *model_;
  }

private:
  static constexpr int highest_derivative = 8;

  /// Everything about one state that the drive's form and the interval fix beforehand.
  struct Tables
  {
    Eigen::Index bodies = 0;                  // coordinates without stiffness, which come first
    Eigen::Index gap_body = -1;               // the one of them that moves the gap, or none
    double body_deflection = 0.0;             // its w
    double body_pull = 0.0;                   // w Gamma of that one
    Eigen::ArrayXd decay, damped;             // -Re lambda, Im lambda, per mode
    Eigen::ArrayXd compliance;                // Gamma/omega^2: quasi-static response to -a
    Eigen::ArrayXd lag;                       // 2 zeta Gamma/omega^3: response to the slope s
    Eigen::ArrayXd standing;                  // f/omega^2: response to the preload
    Eigen::ArrayXd transfer_re, transfer_im;  // H_n
    Eigen::VectorXd kick;                     // change of z per change of the slope s, [re; im]
    double kick_bound = 0.0;                  // what it adds to B
    double kick_gap_integral = 0.0;           // its integral form
    // The line p(t) = line_constant - line_compliance a + line_lag s of the gap.
    double line_constant = 0.0, line_compliance = 0.0, line_lag = 0.0;
    // Column j + 1: the linear form [re; im] that gives the j-th derivative of Re sum w z; column 0 its integral.
    Eigen::MatrixXd derivative;
    Eigen::MatrixXd magnitude;  // column j: |w| |lambda|^j
    SpanEnergy energy;
    Eigen::ArrayXXd factor_re, factor_im;  // column k: exp(lambda tick 2^k) - 1
  };

  /// What moves, in the sizes of one state.
  struct Vectors
  {
    Eigen::VectorXd exponentials;   // [Re z; Im z], each half the modes, the drive's phasor, and padding; of bodies
                                    // displacement and velocity of the polynomial part at body_time_
    Eigen::VectorXd before, trial;  // exponentials at other times: before a step, on trial
    Eigen::VectorXd history;        // exponentials at history_start_
    Eigen::VectorXd displacement, velocity;  // eta and eta'
  };

  /// The contact episode under way.
  struct Episode
  {
    Impact impact;
    double smallest_gap = 0.0;
    double smallest_gap_time = 0.0;  // since onset
    double elapsed = 0.0;            // up to the start of the piece
    double gap_integral = 0.0;
    double impulse = 0.0;  // up to the last change of the contact
    std::uint64_t first_step = 0;
    // the piece: the part of the episode inside the present interval
    double piece_start = 0.0;  // time in the interval
  };

  void tabulate(int state);
  void tabulatePhasor(int state);
  Tables& now()
  {
    return tables_[static_cast<std::size_t>(state_)];
  }
  const Tables& now() const
  {
    return tables_[static_cast<std::size_t>(state_)];
  }
  const LinearState& linearState(int state) const
  {
    return state == 0 ? model_->free() : model_->contact();
  }
  /// Distance from the switching surface, positive inside the present state, and its rate.
  double side() const
  {
    return state_ == 0 ? 1.0 : -1.0;
  }

  void leaveExponentials();
  void startFromCoordinates();
  void advanceInterval(double slope_change, ImpactSink& sink);
  void locateSwitches(ImpactSink& sink);
  void step(std::int64_t ticks, double time);
  std::int64_t safeTicks(std::int64_t left);
  bool hasNoRate() const;
  std::int64_t departureTicks(std::int64_t left);
  bool onWrongSide() const;
  bool crossed() const;
  void switchState(double time, ImpactSink& sink);

  Vectors& vectors()
  {
    return vectors_[static_cast<std::size_t>(state_)];
  }
  const Vectors& vectors() const
  {
    return vectors_[static_cast<std::size_t>(state_)];
  }
  void rotate(Eigen::VectorXd& exponentials, int k) const;
  void rotateTicks(Eigen::VectorXd& exponentials, std::int64_t ticks) const;
  void evaluate();
  void evaluate(const Eigen::VectorXd& exponentials, double time, double& gap, double& rate) const;
  double lineGap(double time) const
  {
    const Tables& t = now();
    const double line = t.line_constant - t.line_compliance * acceleration(time) + t.line_lag * slope_;
    return t.gap_body < 0 ? line : line + t.body_deflection * bodyDisplacement(t.gap_body, time);
  }
  double lineRate(double time) const
  {
    const Tables& t = now();
    const double line = -t.line_compliance * slope_;
    return t.gap_body < 0 ? line : line + t.body_deflection * bodyVelocity(t.gap_body, time);
  }
  /// The second or a higher derivative of the gap now.
  double derivative(int order) const;
  /// Bounds the same derivative of the polynomial p in the present interval.
  double bodyBound(int order) const
  {
    const double size = std::abs(now().body_pull);
    return order == 2 ? size * farthest_ : order == 3 ? size * std::abs(slope_) : 0.0;
  }
  double curvatureBound() const
  {
    return bound_ + bodyBound(2);
  }
  /// The polynomial part of a coordinate without stiffness.
  double bodyDisplacement(Eigen::Index n, double time) const;
  double bodyVelocity(Eigen::Index n, double time) const;
  void moveBodies();
  double bodyEnergy(const Eigen::VectorXd& z, double time) const;
  /// Bounds a derivative of the exponentials' part of the gap from now on; from the second on that is the gap's own,
  /// but for bodyBound().
  double boundOfDerivative(int order) const;
  double boundOfDerivative(int order, const Eigen::VectorXd& z) const;
  void refreshBound();

  double force(double gap) const;
  void describe(double time, double gap, double rate, const Eigen::VectorXd& displacement,
                const Eigen::VectorXd& velocity, HistorySample& sample) const;
  void storeEnergy(const Eigen::VectorXd& displacement, const Eigen::VectorXd& velocity, double gap,
                   EnergyAccount& account) const;
  void beginHistoryPiece();
  void takeHistory();
  void endHistoryInterval();

  void coordinates(const Eigen::VectorXd& exponentials, double time, Eigen::VectorXd& displacement,
                   Eigen::VectorXd& velocity) const;
  void toCoordinates();
  void toExponentials();
  double energy(int state, const Eigen::VectorXd& displacement, const Eigen::VectorXd& velocity) const;
  double acceleration(double time) const
  {
    return start_acceleration_ + slope_ * time;
  }

  void openAccount();
  void takeOverAccount(const SwitchedMotion& previous);
  SpanEnergy::Moment moment(const Eigen::VectorXd& exponentials, double time) const;
  void openSpan();
  void closeSpan();
  /// Enters what went on in a span of the present state.
  void enter(const SpanEnergy::Amounts& amounts, EnergyAccount& account) const;

  void beginEpisode(double offset, double elapsed, double approach_speed);
  void openIntegrals();
  void closeIntegrals();
  void beginPiece();
  void endPiece();
  void closeForce();
  void endEpisode(ImpactSink& sink);
  void notePeak(double gap, double time);
  void watchPeak(double start, std::int64_t ticks, double gap_before, double rate_before);
  struct GapSample
  {
    std::int64_t tick;
    double gap, rate;
  };
  /// Of the step in which a peak is searched; at depth 0 still unknown.
  struct DerivativeBounds
  {
    double third = 0.0;
    double highest = 0.0;
  };
  void refinePeak(double start, const GapSample& from, const GapSample& to, DerivativeBounds bounds, int depth);

  std::shared_ptr<const SwitchedModel> model_;
  bool phasor_;
  double length_ = 0.0;
  double inverse_length_ = 0.0;
  double tick_ = 0.0;
  int doublings_ = 0;  // K
  std::int64_t switch_limit_ = switch_allowance;
  double lowest_frequency_ = 0.0;  // of S1 that moves the gap, rad/s
  double drive_frequency_ = 0.0;
  double drive_amplitude_ = 0.0;
  std::array<Tables, 2> tables_;

  int state_ = 0;
  bool in_coordinates_ = true;  // the state is in displacement_ and velocity_, not yet in exponentials
  std::array<Vectors, 2> vectors_;
  double time_ = 0.0;  // in the interval
  double start_acceleration_ = 0.0;
  double slope_ = 0.0;
  double farthest_ = 0.0;   // greatest |a| of the interval
  double body_time_ = 0.0;  // in the interval
  double gap_ = 0.0;
  double rate_ = 0.0;
  double bound_ = 0.0;       // B, of the exponentials
  double resolution_ = 0.0;  // rounding error of the gap
  std::uint64_t intervals_ = 0;
  std::uint64_t switches_ = 0;
  std::uint64_t switch_limit_reached_ = 0;
  std::uint64_t steps_total_ = 0;
  std::uint64_t peak_evaluations_ = 0;
  std::uint64_t impacts_ = 0;
  double contact_time_ = 0.0;  // s
  Episode episode_;
  EnergyAccount account_;             // of the spans that have ended; what is stored is filled in when asked for
  std::uint64_t span_intervals_ = 0;  // of the harmonic drive since the span began
  HistorySample* history_ = nullptr;  // where the next sample goes, if anywhere
  std::size_t history_size_ = 0;      // samples an interval
  std::size_t history_taken_ = 0;     // of this interval
  double history_start_ = 0.0;        // start of the piece from which samples are taken, time in the interval
};

}  // namespace vibro_impact::core
