#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>

#include <Eigen/Core>

#include "gap_stretch.h"
#include "lanes.h"
#include "span_energy.h"
#include "state_tables.h"
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
/// A switch is found by steps that cannot skip one. A step is 2^k ticks, one product for each exponential, and is
/// judged by gap, rate and acceleration at its two ends: between them the gap is a polynomial of fifth degree
/// (GapStretch) but for the spread of the exponentials about theirs, which is bounded by amplitudes, as these only
/// decay. Modes too fast for such a step are left out of the polynomial and have their amplitude for a spread. Where
/// the gap cannot be shown to keep its sign, the step ends before the polynomial's first root, or is tried again
/// shorter. Where a bound B_3 of the third derivative shows that the parabola of a moment tells of a root, and of no
/// earlier one, Newton's method leads from there to a tick just past it, as soon as the gap can be told from zero
/// (resolution_, its rounding error); the reported time and speed are those of the root. Where none of this shows
/// anything, a gap g > 0 with the rate g' cannot reach zero before
///
///   s = (g' + sqrt(g'^2 + 2 g B))/B,        B = sum_n |w_n| |lambda_n|^2 |z_n|
///
/// Exactly zero gap with zero velocity is no switch: there the first derivative that is not zero decides, and the
/// motion is taken as far from the root as the Taylor series and a bound of its remainder allow.
///
/// Under a linear drive the chord of the gap over an interval and a bound of the distance from it come first: most
/// intervals have a gap much larger than that, and need no more.
class SwitchedMotion
{
public:
  /// No more switches are made in one interval than `switch_allowance` and one per half period of the highest
  /// frequency. Beyond these the motion stays in S1, where energy is neither made nor lost, to the end of the interval,
  /// and the interval is counted.
  static constexpr int switch_allowance = 256;

  /// Steps in one interval, other than long ones, without a switch after which the smallest step becomes twice the
  /// shortest of them (and again after as many). A crossing that such a step overruns is still found by halving it;
  /// only a pair of crossings closer than the step is not.
  static constexpr int steps_before_coarser = 256;

  /// `phasor`: whether there is a harmonic drive D besides the linear one.
  SwitchedMotion(std::shared_ptr<const SwitchedModel> model, bool phasor);

  /// Sets the length of the intervals (s, > 0) and tabulates the factors. May allocate.
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

  /// Advances over as many of the next `count` intervals, at the ends of which the base acceleration is given, as are
  /// easily seen to be without a switch. Writes gap and force at the end of each and returns their number;
  /// advanceLinear() goes on from there. One call or many make no difference.
  std::size_t advanceSteadily(double from, const double* accelerations, std::size_t count, double* gap, double* force);

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
    return moment_known_ ? rate_ : moment().rate;
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
    return grid_.tick;
  }
  const SwitchedModel& model() const
  {
    return *model_;
  }

private:
  /// Rounding error of the gap, as a share of the terms it is summed from: an allowance for what adds up in 1e5
  /// intervals.
  static constexpr double gap_rounding = 128.0 * std::numeric_limits<double>::epsilon();

  /// The most ticks that are made at a root to get past the gap's rounding error: 1e-9 of the shortest period.
  static constexpr double most_ticks_through = 1024.0;

  /// What exceeds the greatest compression so far by no more than this is no peak.
  static constexpr double peak_share = 1.0 + 1.0e-10;

  /// What moves, in the sizes of one state.
  struct Vectors
  {
    Eigen::VectorXd exponentials;  // [Re z; Im z], each half the modes, the drive's phasor, and padding; of bodies
                                   // displacement and velocity of the polynomial part at body_time_
    Eigen::VectorXd there, probe;  // exponentials at other times: at the end of a step, inside it
    Eigen::VectorXd history;       // exponentials at history_start_
    Eigen::VectorXd displacement, velocity;  // eta and eta', padded
    int stride = 0;                          // long steps are of 2^stride ticks
    // Over 2^k ticks, of those k whose bit is set.
    std::array<Spread, 64> spreads, slow_spreads;
    std::uint64_t known_spreads = 0, known_slow_spreads = 0;
    Moment slow;  // of the exponentials as they are, without the modes that are too fast for 2^slow_stride ticks
    int slow_stride = -1;       // -1: unknown
    double third_bound = -1.0;  // of the third derivative; unknown where < 0

    /// The exponentials have changed other than by time, which only makes them smaller.
    void forgetBounds()
    {
      known_spreads = known_slow_spreads = 0;
      slow_stride = -1;
      third_bound = -1.0;
    }
  };

  /// The contact episode under way.
  struct Episode
  {
    Impact impact;
    double compression = 0.0;       // greatest so far
    double compression_time = 0.0;  // since onset
    double elapsed = 0.0;           // up to the start of the piece
    double gap_integral = 0.0;
    double impulse = 0.0;  // up to the last change of the contact
    std::uint64_t first_step = 0;
    // the piece: the part of the episode inside the present interval
    double piece_start = 0.0;  // time in the interval
  };

  StateTables& now()
  {
    return tables_[static_cast<std::size_t>(state_)];
  }
  const StateTables& now() const
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
  std::int64_t stride(std::int64_t left, double time);
  std::int64_t land(std::int64_t left, double time);
  void step(std::int64_t ticks, double time);
  std::int64_t safeTicks(std::int64_t left);
  bool approaches();
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
  struct Ticks
  {
    std::uint64_t tabulated;
    double series;
  };
  /// Tabulated factors for long times, the series for what is short, forwards or back.
  Ticks split(std::int64_t ticks) const
  {
    if (ticks < 0)
    {
      return {0, static_cast<double>(ticks)};
    }
    const std::int64_t strides = ticks >> grid_.shortest_stride;
    const std::int64_t low = ticks - (strides << grid_.shortest_stride);
    return {static_cast<std::uint64_t>(strides), static_cast<double>(low)};
  }
  /// to = from, `ticks` later; the gap's distance from zero there, and its derivatives.
  Moment move(const Eigen::VectorXd& from, std::int64_t ticks, double time, Eigen::VectorXd& to) const;
  void move(const Eigen::VectorXd& from, std::int64_t ticks, Eigen::VectorXd& to) const;
  void evaluate();
  /// The gap's distance from zero, positive inside the present state, with its derivatives.
  Moment distance(const Eigen::VectorXd& exponentials, double time) const;
  Moment distance(const Forms& forms, double time) const
  {
    const double sign = side();
    Moment distance{sign * (line_start_ + line_slope_ * time + forms.first), sign * (line_slope_ + forms.second),
                    sign * forms.third};
    if (now().gap_body >= 0)
    {
      addBody(distance, time);
    }
    return distance;
  }
  Moment distance() const
  {
    return Moment{side() * gap_, side() * rate_, side() * acceleration_};
  }
  /// Goes on to the exponentials `there`.
  void arrive(const Moment& distance, double time);
  void setDistance(const Moment& distance);
  bool crossInterval(double slope_change);
  void refreshSag();
  /// The gap now with its derivatives.
  Moment moment() const;
  /// Makes rate_ and acceleration_ those of now.
  void completeMoment();
  /// The line p(t) of the present state and drive.
  void setLine();
  void addBody(Moment& distance, double time) const;
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
    return boundOfDerivative(2) + bodyBound(2);
  }
  double thirdBound();
  /// The polynomial part of a coordinate without stiffness.
  double bodyDisplacement(Eigen::Index n, double time) const;
  double bodyVelocity(Eigen::Index n, double time) const;
  void moveBodies();
  double bodyEnergy(const Eigen::VectorXd& z, double time) const;
  /// Bounds a derivative of the exponentials' part of the gap from now on; from the second on that is the gap's own,
  /// but for bodyBound().
  double boundOfDerivative(int order) const;
  void refreshResolution();
  /// Of the gap from now on over 2^k ticks.
  const Spread& spread(int k);
  /// The same without the modes that are too fast for such a step.
  const Spread& slowSpread(int k);

  double force(double gap) const;
  void describe(double time, double gap, double rate, const Eigen::Ref<const Eigen::VectorXd>& displacement,
                const Eigen::Ref<const Eigen::VectorXd>& velocity, HistorySample& sample) const;
  void storeEnergy(EnergyAccount& account) const;
  void storeEnergy(const Eigen::Ref<const Eigen::VectorXd>& displacement,
                   const Eigen::Ref<const Eigen::VectorXd>& velocity, double gap, EnergyAccount& account) const;
  void beginHistoryPiece();
  void takeHistory();
  void endHistoryInterval();

  void toCoordinates();
  void toExponentials();
  /// From padded vectors to padded vectors.
  void convert(const Eigen::VectorXd& exponentials, double time, Eigen::VectorXd& displacement,
               Eigen::VectorXd& velocity) const;
  Conversion conversion(const Eigen::VectorXd& exponentials, double time) const;
  /// Displacement and velocity to the coordinates of the state whose mapping it is.
  static void map(const Eigen::MatrixXd& mapping, const Vectors& from, Vectors& to);
  void mapToOtherState();
  double storedEnergy() const
  {
    const Eigen::Index modes = now().modes();
    return energy(vectors().displacement.head(modes), vectors().velocity.head(modes));
  }
  double energy(const Eigen::Ref<const Eigen::VectorXd>& displacement,
                const Eigen::Ref<const Eigen::VectorXd>& velocity) const;
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
  void notePeak(double compression, double time);
  struct Sample
  {
    std::int64_t tick;  // since the start of the step
    Moment distance;
  };
  /// What a step shows of the peak: its two ends, and the stretch between them without what is too fast.
  struct Step
  {
    double start;  // time in the interval
    Sample from, to;
  };
  double leastPeak() const;
  void watchPeak(const Step& step, const GapStretch& slow, std::int64_t range);
  bool findPeak(const Step& step, const GapStretch& slow, std::int64_t range);
  void searchPeak(const Step& step, int depth);
  Sample samplePeak(double start, std::int64_t tick);
  void climb(double start, Sample sample, std::int64_t least, std::int64_t most);

  std::shared_ptr<const SwitchedModel> model_;
  bool phasor_;
  std::array<StateTables, 2> tables_;
  TickGrid grid_;
  std::int64_t switch_limit_ = switch_allowance;
  double lowest_frequency_ = 0.0;  // of S1 that moves the gap, rad/s
  double drive_frequency_ = 0.0;
  double drive_amplitude_ = 0.0;

  int state_ = 0;
  bool in_coordinates_ = true;  // the state is in displacement_ and velocity_, not yet in exponentials
  std::array<Vectors, 2> vectors_;
  double time_ = 0.0;  // in the interval
  double start_acceleration_ = 0.0;
  double slope_ = 0.0;
  double farthest_ = 0.0;    // greatest |a| of the interval
  double line_start_ = 0.0;  // p(t) = line_start_ + line_slope_ t, but for a body
  double line_slope_ = 0.0;
  double body_time_ = 0.0;  // in the interval
  double gap_ = 0.0;
  double rate_ = 0.0;
  double acceleration_ = 0.0;
  double resolution_ = 0.0;  // rounding error of the gap
  // Bounds of how far the gap and its rate are from their chords over the next interval.
  double sag_ = 0.0;
  double sag_rate_ = 0.0;
  bool moment_known_ = true;  // whether rate_ and acceleration_ are of now
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
